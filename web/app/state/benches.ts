/** The list with what is new of one of its benches, in the order in which the daemon tells of them. */
export function renewed<B extends { name: string }>(benches: readonly B[], bench: B): B[] {
	return benches.some(({ name }) => name === bench.name) ? benches.map((one) => (one.name === bench.name ? bench : one)) : [...benches, bench];
}
