/**
 * A value that follows another after it has been constant for a while, so that not every key stroke sends a request.
 */
export function debounced<T>(source: () => T, wait_ms: number): { readonly value: T } {
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
