/** Durations and times. */

/** `6 min 20 s`, `43 s`, `0.4 s`. */
export function formatDuration(seconds: number | null | undefined): string {
	if (seconds == null || !Number.isFinite(seconds)) return '–';
	if (seconds < 10) return `${Math.max(0, seconds).toFixed(1)} s`;
	const whole = Math.round(seconds);
	if (whole < 60) return `${whole} s`;
	const minutes = Math.floor(whole / 60);
	if (minutes < 60) return `${minutes} min ${whole % 60} s`;
	return `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

/** The largest unit only: `6 min`, `2 h`, `43 s`. */
export function formatShortDuration(seconds: number): string {
	const whole = Math.round(seconds);
	if (!Number.isFinite(seconds) || whole < 60) return formatDuration(seconds);
	const minutes = Math.floor(whole / 60);
	return minutes < 60 ? `${minutes} min` : `${Math.floor(minutes / 60)} h`;
}

/** `1,204.5 s`: a time on the clock of a run. */
export const formatRunTime = (seconds: number): string => `${seconds.toLocaleString('en', { minimumFractionDigits: 1, maximumFractionDigits: 1 })} s`;

/** `3:51`, in the style of a count-down. */
export function formatCountdown(seconds: number): string {
	const whole = Math.max(0, Math.round(seconds));
	const tail = `${String(Math.floor(whole / 60) % 60)}:${String(whole % 60).padStart(2, '0')}`;
	return whole < 3600 ? tail : `${Math.floor(whole / 3600)}:${tail.padStart(5, '0')}`;
}

/** Local date and time to the minute; the full time stamp belongs in a title. */
export function formatDateTime(iso: string | null | undefined): string {
	if (!iso) return '–';
	const at = new Date(iso);
	if (Number.isNaN(at.getTime())) return iso;
	const two = (n: number) => String(n).padStart(2, '0');
	return `${at.getFullYear()}-${two(at.getMonth() + 1)}-${two(at.getDate())} ${two(at.getHours())}:${two(at.getMinutes())}`;
}
