export type Mood = 'good' | 'busy' | 'warn' | 'bad' | 'calm';

/** Every state as word, icon and colour; an unknown state is displayed as a word. */
const STATES: Record<string, { word: string; icon: string; mood: Mood }> = {
	idle: { word: 'IDLE', icon: '○', mood: 'good' },
	queued: { word: 'QUEUED', icon: '◌', mood: 'calm' },
	arming: { word: 'ARMING', icon: '◔', mood: 'busy' },
	running: { word: 'RUNNING', icon: '▶', mood: 'busy' },
	paused: { word: 'PAUSED', icon: 'Ⅱ', mood: 'warn' },
	securing: { word: 'SECURING', icon: '◑', mood: 'warn' },
	completed: { word: 'DONE', icon: '✓', mood: 'good' },
	stopped: { word: 'STOPPED', icon: '■', mood: 'warn' },
	aborted: { word: 'ABORTED', icon: '■', mood: 'bad' },
	failed: { word: 'FAILED', icon: '✕', mood: 'bad' },
	interrupted: { word: 'INTERRUPTED', icon: '⚡', mood: 'bad' },
	fault: { word: 'FAULT', icon: '✕', mood: 'bad' },
	offline: { word: 'OFFLINE', icon: '⊘', mood: 'bad' },
	blocked: { word: 'BLOCKED', icon: '⊘', mood: 'bad' },
	no_contact: { word: 'NO CONTACT', icon: '⊘', mood: 'bad' },
	safe_verified: { word: 'safe, verified', icon: '✓', mood: 'good' },
	safe_commanded: { word: 'safe, not read back', icon: '◔', mood: 'warn' },
	unsafe_unknown: { word: 'NOT KNOWN SAFE', icon: '⚠', mood: 'bad' },
};

export function sayState(state: string): { word: string; icon: string; mood: Mood } {
	return STATES[state] ?? { word: state.replaceAll('_', ' ').toUpperCase(), icon: '?', mood: 'warn' };
}

const FINAL = new Set(['completed', 'stopped', 'aborted', 'failed', 'interrupted']);

export function isFinal(state: string): boolean {
	return FINAL.has(state);
}
