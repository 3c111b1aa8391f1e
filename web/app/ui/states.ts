export type Tone = 'good' | 'busy' | 'warn' | 'bad' | 'calm';

export interface StatusLabel {
	label: string;
	icon: string;
	tone: Tone;
}

/** Every state as word, icon and colour; an unknown state is displayed as a word. */
const STATES: Record<string, StatusLabel> = {
	idle: { label: 'IDLE', icon: '○', tone: 'good' },
	queued: { label: 'QUEUED', icon: '◌', tone: 'calm' },
	arming: { label: 'ARMING', icon: '◔', tone: 'busy' },
	running: { label: 'RUNNING', icon: '▶', tone: 'busy' },
	paused: { label: 'PAUSED', icon: 'Ⅱ', tone: 'warn' },
	securing: { label: 'SECURING', icon: '◑', tone: 'warn' },
	completed: { label: 'DONE', icon: '✓', tone: 'good' },
	stopped: { label: 'STOPPED', icon: '■', tone: 'warn' },
	aborted: { label: 'ABORTED', icon: '■', tone: 'bad' },
	failed: { label: 'FAILED', icon: '✕', tone: 'bad' },
	interrupted: { label: 'INTERRUPTED', icon: '⚡', tone: 'bad' },
	removed: { label: 'REMOVED', icon: '−', tone: 'calm' },
	fault: { label: 'FAULT', icon: '✕', tone: 'bad' },
	offline: { label: 'OFFLINE', icon: '⊘', tone: 'bad' },
	blocked: { label: 'BLOCKED', icon: '⊘', tone: 'bad' },
	no_contact: { label: 'NO CONTACT', icon: '⊘', tone: 'bad' },
	safe_verified: { label: 'safe, verified', icon: '✓', tone: 'good' },
	safe_commanded: { label: 'safe, not read back', icon: '◔', tone: 'warn' },
	unsafe_unknown: { label: 'NOT KNOWN SAFE', icon: '⚠', tone: 'bad' },
};

export function stateLabel(state: string): StatusLabel {
	return STATES[state] ?? { label: state.replaceAll('_', ' ').toUpperCase(), icon: '?', tone: 'warn' };
}

const EARLY_ENDS = ['stopped', 'aborted', 'failed', 'interrupted'];
export const FINAL_STATES = ['completed', ...EARLY_ENDS];

export const isFinal = (state: string): boolean => FINAL_STATES.includes(state);
/** The run ended before its last step. */
export const isEarlyEnd = (state: string): boolean => EARLY_ENDS.includes(state);
