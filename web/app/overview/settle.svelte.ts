/** A value that follows another once that has stood still: a question is not asked at every key stroke. */
export function settle<T>(source: () => T, wait_ms: number): { readonly value: T } {
	let value: T = $state.raw(source());
	$effect(() => {
		const next = source();
		const timer = setTimeout(() => (value = next), wait_ms);
		return () => clearTimeout(timer);
	});
	return {
		get value() {
			return value;
		},
	};
}
