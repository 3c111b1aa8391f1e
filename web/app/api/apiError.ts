import type { Problem } from './types';

/** The error that a page shows for a failed request: the daemon's problem document, or the reason why there is none. */
export class ApiError extends Error {
	readonly status: number;
	readonly title: string;
	readonly line: number | null;
	readonly column: string | null;

	constructor(problem: Partial<Problem>) {
		super(problem.detail || problem.title || 'the daemon gave no reason');
		this.status = problem.status ?? 0;
		this.title = problem.title ?? 'Refused';
		this.line = problem.line ?? null;
		this.column = problem.column ?? null;
	}

	/** The samples were moved to the archive: no attempt gets them from here. */
	get archived(): boolean {
		return this.status === 410;
	}

	/** The daemon did not answer: the page should wait; the user has nothing to correct. */
	get offline(): boolean {
		return this.status === 0;
	}
}

export function toApiError(error: unknown): ApiError {
	if (error instanceof ApiError) return error;
	if (error instanceof TypeError) {
		return new ApiError({ title: 'No contact', detail: 'The daemon does not answer. Is `jointbench serve` still running?' });
	}
	return new ApiError({ title: 'Not understood', detail: error instanceof Error ? error.message : String(error), status: 500 });
}
