import type { ChannelHealth } from '../api/types';

/**
 * The last value is older than three periods, but at least one second, because the daemon reports on a bench twice per
 * second.
 */
export const isStale = ({ rate_hz }: Pick<ChannelHealth, 'rate_hz'>, age_s: number): boolean => age_s > Math.max(1, 3 / (rate_hz ?? 3));
