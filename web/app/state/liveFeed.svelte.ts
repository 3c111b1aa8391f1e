import type { Frame } from '../api/frame';
import type { Channel, RunEvent } from '../api/types';
import { SampleBuffer } from '../plot/sampleBuffer';
import { smoothFollow } from '../plot/smoothFollow';

/** What the daemon sends about one run while it is active. Benches may run at the same time: each run has its own. */
export class LiveFeed {
	events: RunEvent[] = $state.raw([]);
	channels: Channel[] = $state.raw([]);
	/** The columns grow in place; `lab.frames` signals changes. */
	samples: SampleBuffer | null = $state.raw(null);
	/** Frames that this client has lost. */
	dropped = $state(0);
	/** End time of plots that follow the run [s]. */
	shown_s: number | null = $state(null);
	/** Time of the last samples: it gives the age of the displayed values. */
	lastFrame_ms = 0;

	add(event: RunEvent): void {
		if (!this.events.some(({ sequence }) => sequence === event.sequence)) this.events = [...this.events, event];
	}

	setChannels(channels: Channel[]): void {
		const names = channels.map(({ name }) => name);
		this.channels = channels;
		if (this.samples?.names.join() !== names.join()) this.samples = new SampleBuffer(names);
	}

	push(frame: Frame, now_ms: number): void {
		this.samples?.push(frame);
		this.dropped = frame.dropped;
		this.lastFrame_ms = now_ms;
	}

	/** Moves the end of the plots towards the newest sample. Returns whether they have not yet reached it. */
	follow(passed_ms: number): boolean {
		const newest_s = this.samples?.last_s ?? null;
		this.shown_s = newest_s === null ? null : smoothFollow(this.shown_s, newest_s, passed_ms);
		return this.shown_s !== newest_s;
	}
}
