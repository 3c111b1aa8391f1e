/** Search term for the runs of a bench. Its name can contain spaces. */
export const benchTerm = (name: string): string => `"bench:${name}"`;

/** The list with one updated bench, in the order of the daemon. */
export function withBench<B extends { name: string }>(benches: readonly B[], bench: B): B[] {
	return benches.some(({ name }) => name === bench.name) ? benches.map((one) => (one.name === bench.name ? bench : one)) : [...benches, bench];
}
