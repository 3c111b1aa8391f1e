import { api } from '../api/client';
import { connectLive } from '../api/live';
import { toApiError } from '../api/apiError';
import type { Bench, LiveMessage, Progress, RunState } from '../api/types';
import type { Frame } from '../api/frame';
import { SvelteMap } from 'svelte/reactivity';
import { withBench } from './benches';
import { LiveFeed } from './liveFeed.svelte';
import { tokenRequest } from './tokenRequest.svelte';
import { procedureTitles } from './procedureTitles.svelte';
import { role } from './role.svelte';

/** After this time without a message the page sends a request. */
const QUIET_MS = 1500;
/** After this time without a message the contact is lost. */
const STALE_MS = 4000;

/** Feeds of ended runs that stay in memory. */
const MOST_FEEDS = 2;
const BENCH_KEY = 'jointbench.bench';

const reducedMotion = matchMedia('(prefers-reduced-motion: reduce)');

/** The last state from the daemon, which all pages display. */
class LabState {
	benches: Bench[] | null = $state.raw(null);
	progress: Record<number, Progress> = $state({});
	runStates: Record<number, RunState> = $state({});
	/** Events, channels and samples of the last runs, by run. */
	readonly feeds = new SvelteMap<number, LiveFeed>();
	/** Incremented with every event of a run. */
	events = $state(0);
	/** Incremented with every frame, so that plots redraw. */
	frames = $state(0);
	/** Incremented when any model version or verdict of a run changes. */
	models = $state(0);
	/** Incremented when a note about any run is written. */
	notes = $state(0);
	/** Incremented when a user's effect changes, so that diagnoses that may suggest it are requested again. */
	effects = $state(0);
	/** Incremented when the queue of a bench changes. */
	queues = $state(0);
	/** Incremented when an autopilot makes a step or ends. */
	autopilots = $state(0);
	connected = $state(false);
	lastMessage_ms = $state(performance.now());
	now_ms = $state(performance.now());
	/**
	 * The bench of the pages: from the address, from the displayed run, or chosen by the user. The tab keeps it over a
	 * reload, because the software stop acts on it.
	 */
	private chosenName: string | null = $state(sessionStorage.getItem(BENCH_KEY));
	get chosen(): string | null {
		return this.chosenName;
	}
	set chosen(name: string) {
		this.chosenName = name;
		sessionStorage.setItem(BENCH_KEY, name);
	}
	bench: Bench | null = $derived(this.benches?.find((bench) => bench.name === this.chosen) ?? this.benches?.[0] ?? null);
	/** Milliseconds since the last message of the daemon. */
	silence_ms = $derived(Math.max(0, this.now_ms - this.lastMessage_ms));
	contactLost = $derived(!this.connected || this.silence_ms > STALE_MS);

	/** Time of the last report on a bench: it gives the age of the displayed data, on every page. */
	readonly reported_ms = new WeakMap<Bench, number>();

	/** Stores a bench from a message of the daemon. */
	updateBench(bench: Bench): void {
		this.reported_ms.set(bench, performance.now());
		this.benches = withBench(this.benches ?? [], bench);
	}

	/** The bench of a run, else the bench of the pages. */
	benchOf(run: { bench: string } | undefined): Bench | null {
		return this.benches?.find(({ name }) => name === run?.bench) ?? this.bench;
	}

	start(): () => void {
		const disconnect = connectLive({
			message: (message) => this.handleMessage(message),
			frame: (frame) => this.handleFrame(frame),
			connected: (up) => this.setConnected(up),
		});
		const clock = setInterval(() => this.tick(), 250);
		void this.requestBenches();
		return () => {
			disconnect();
			clearInterval(clock);
			this.connected = false;
		};
	}

	private tick(): void {
		this.now_ms = performance.now();
		if (this.now_ms - Math.max(this.lastMessage_ms, this.lastRequest_ms) > QUIET_MS && !this.isRequesting) void this.requestBenches();
	}

	private isRequesting = false;
	private lastRequest_ms = 0;

	private async requestBenches(): Promise<void> {
		this.isRequesting = true;
		this.lastRequest_ms = performance.now();
		try {
			const benches = await api.benches(AbortSignal.timeout(2500));
			this.noteMessage();
			for (const bench of benches) this.reported_ms.set(bench, this.lastMessage_ms);
			this.benches = benches;
			if (!benches.some(({ name }) => name === this.chosen)) {
				const first = benches.find(({ run }) => run !== null) ?? benches[0];
				if (first) this.chosen = first.name;
			}
		} catch (failure) {
			// The age of the data shows a missing answer.
			tokenRequest.isOpen ||= toApiError(failure).status === 401;
		}
		this.isRequesting = false;
	}

	private noteMessage(): void {
		this.lastMessage_ms = performance.now();
		this.now_ms = this.lastMessage_ms;
	}

	private setConnected(up: boolean): void {
		this.connected = up;
		if (!up) return;
		// The daemon may have restarted without the active run, so the former states are discarded.
		this.runStates = {};
		this.progress = {};
		void this.requestBenches();
		void procedureTitles.load();
		void api.health().then(({ access }) => (role.isReadOnly = access === 'read'), () => {});
	}

	private handleMessage(message: LiveMessage): void {
		this.noteMessage();
		switch (message.type) {
			case 'bench': {
				this.updateBench(message.bench);
				break;
			}
			case 'state':
				this.runStates[message.run] = message.state;
				break;
			case 'progress':
				this.progress[message.run] = message.progress;
				break;
			case 'event':
				this.feedOf(message.run).add(message.event);
				this.events += 1;
				break;
			case 'note':
				this.notes += 1;
				break;
			case 'channels':
				this.streamed = this.feedOf(message.run);
				this.streamed.setChannels(message.channels);
				break;
			case 'model':
			case 'verdict':
				this.models += 1;
				break;
			case 'effects':
				this.effects += 1;
				break;
			case 'queue':
				this.queues += 1;
				break;
			case 'autopilot':
				this.autopilots += 1;
				break;
		}
	}

	/** The feed of the next frames: that of the last message about channels. */
	private streamed: LiveFeed | null = null;

	private feedOf(run: number): LiveFeed {
		const known = this.feeds.get(run);
		if (known) return known;
		const feed = new LiveFeed();
		this.feeds.set(run, feed);
		const isOver = (one: number) => one !== run && !this.benches?.some((bench) => bench.run === one);
		const oldest = [...this.feeds.keys()].find(isOver);
		if (this.feeds.size > MOST_FEEDS + (this.benches?.length ?? 0) && oldest !== undefined) this.feeds.delete(oldest);
		return feed;
	}

	private drawing = false;
	private hasNewFrame = false;
	private drawn_ms = 0;

	/** Plots are drawn once per image of the screen, at any rate of frames, and never in a hidden tab. */
	private handleFrame(frame: Frame): void {
		this.noteMessage();
		this.streamed?.push(frame, this.lastMessage_ms);
		this.hasNewFrame = true;
		if (this.drawing) return;
		this.drawing = true;
		this.drawn_ms = performance.now();
		requestAnimationFrame(this.draw);
	}

	/**
	 * Continues between two frames until the newest sample is displayed. With reduced motion, plots move only with the
	 * frames.
	 */
	private readonly draw = (now_ms: number): void => {
		const passed_ms = reducedMotion.matches ? Infinity : Math.max(0, now_ms - this.drawn_ms);
		this.drawing = false;
		for (const feed of this.feeds.values()) this.drawing = feed.follow(passed_ms) || this.drawing;
		this.drawn_ms = now_ms;
		if (this.hasNewFrame) this.frames += 1;
		this.hasNewFrame = false;
		if (this.drawing) requestAnimationFrame(this.draw);
	};
}

export const lab = new LabState();
