/**
 * The newest samples of a run in memory, as contiguous columns, so that a window needs no copy. Missing ranges are
 * stored as intervals; the plot keeps them blank.
 */
export class SampleBuffer {
	private readonly capacity: number;
	private time: Float64Array;
	private columns: Float32Array[];
	private length = 0;
	private period_s = 0;
	private lastSequence: number | null = null;
	private lastDropped = 0;
	gaps: [number, number][] = [];

	constructor(
		readonly names: readonly string[],
		capacity = 120_000,
	) {
		this.capacity = capacity;
		this.time = new Float64Array(2 * capacity);
		this.columns = names.map(() => new Float32Array(2 * capacity));
	}

	get rows(): number {
		return this.length;
	}

	get first_s(): number | null {
		return this.length ? this.time[0]! : null;
	}

	get last_s(): number | null {
		return this.length ? this.time[this.length - 1]! : null;
	}

	/** Newest value of a channel. */
	latest(name: string): number | null {
		const column = this.columns[this.names.indexOf(name)];
		const value = this.length && column ? column[this.length - 1]! : Number.NaN;
		return Number.isFinite(value) ? value : null;
	}

	/** Adds the rows of one frame. `time` is column 0 of the frame, relative to `t0_s`. */
	push(frame: { sequence: number; dropped: number; rows: number; t0_s: number; columns: Float32Array[] }): void {
		const relative = frame.columns[0];
		if (!relative || frame.rows === 0 || frame.columns.length !== this.names.length) return;
		const begins_s = frame.t0_s + relative[0]!;
		const last_s = this.last_s;
		if (last_s !== null && begins_s <= last_s) return;
		if (this.length + frame.rows > 2 * this.capacity) this.dropOldest();
		if (last_s !== null && this.lost(frame, begins_s - last_s)) this.gaps.push([last_s, begins_s]);
		const room = Math.min(frame.rows, 2 * this.capacity - this.length);
		for (let i = 0; i < room; i++) this.time[this.length + i] = frame.t0_s + relative[i]!;
		frame.columns.forEach((column, c) => this.columns[c]!.set(column.subarray(0, room), this.length));
		this.length += room;
		this.lastSequence = frame.sequence;
		this.lastDropped = frame.dropped;
		if (this.period_s === 0 && room > 4) this.period_s = (this.last_s! - begins_s) / (room - 1);
	}

	/** Rows with `from ≤ time ≤ to` and one more on each side, so that lines reach the border. */
	window(from_s: number, to_s: number): { time: Float64Array; columns: Float32Array[] } {
		const begin = Math.max(0, this.find(from_s) - 1);
		const end = Math.min(this.length, this.find(to_s) + 1);
		return { time: this.time.subarray(begin, end), columns: this.columns.map((column) => column.subarray(begin, end)) };
	}

	private lost(frame: { sequence: number; dropped: number }, pause_s: number): boolean {
		const skipped = frame.dropped > this.lastDropped;
		const restarted = this.lastSequence !== null && frame.sequence < this.lastSequence;
		return pause_s > Math.max(5 * this.period_s, 1e-9) && (skipped || restarted || this.period_s > 0);
	}

	private find(at_s: number): number {
		let low = 0;
		let high = this.length;
		while (low < high) {
			const middle = (low + high) >> 1;
			if (this.time[middle]! < at_s) low = middle + 1;
			else high = middle;
		}
		return low;
	}

	private dropOldest(): void {
		const keep = Math.min(this.capacity, this.length);
		const from = this.length - keep;
		this.time.copyWithin(0, from, this.length);
		for (const column of this.columns) column.copyWithin(0, from, this.length);
		this.length = keep;
		const first = this.time[0]!;
		this.gaps = this.gaps.filter(([, end]) => end > first);
	}
}
