import { expect, it } from 'vitest';
import { pairWithMeta } from './upload';

it('gives every table of a drop the meta file of the drop', () => {
	const [csv, parquet, meta] = ['a.csv', 'b.parquet', 'meta.json'].map((name) => new File(['x'], name));
	expect(pairWithMeta([csv!, meta!, parquet!])).toEqual([
		{ file: csv, meta },
		{ file: parquet, meta },
	]);
	expect(pairWithMeta([csv!])).toEqual([{ file: csv, meta: null }]);
});
