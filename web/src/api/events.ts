import { address } from './http';
import type { HistoryLabels, JobState } from './types';

export interface Events {
  project(event: { revision: number; history: HistoryLabels }): void;
  job(event: JobState): void;
  result(event: { id: string; revision: number; job: string | null }): void;
  problem(event: { message: string; hint: string | null }): void;
}

/** News from the server: progress, results, changes made in another tab. The browser opens the stream again by itself. */
export function listen(listener: Events): EventSource {
  const source = new EventSource(address('events'));
  for (const type of ['project', 'job', 'result', 'problem'] as const) {
    source.addEventListener(type, (event) => {
      listener[type](JSON.parse((event as MessageEvent<string>).data) as never);
    });
  }
  return source;
}
