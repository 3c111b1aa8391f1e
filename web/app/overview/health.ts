import type { ChannelHealth } from '../api/types';

/** Seconds since the channel's last value; infinite where there was none. */
export const ageOf = ({ at }: Pick<ChannelHealth, 'at'>, now_ms: number): number => (at ? Math.max(0, now_ms - Date.parse(at)) / 1000 : Infinity);

/** The last value is older than three periods. Under a second the page cannot tell: a bench is told of twice in one. */
export const isOld = ({ rate_hz }: Pick<ChannelHealth, 'rate_hz'>, age_s: number): boolean => age_s > Math.max(1, 3 / (rate_hz ?? 3));
