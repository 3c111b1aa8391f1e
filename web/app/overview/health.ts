import type { ChannelHealth } from '../api/types';

/** The last value is older than three periods. Under a second the page cannot tell: a bench is told of twice in one. */
export const isOld = ({ rate_hz }: Pick<ChannelHealth, 'rate_hz'>, age_s: number): boolean => age_s > Math.max(1, 3 / (rate_hz ?? 3));
