import { address } from './http';
import type { Event as News } from './types';

export type Events = { [Kind in News['type']]: (event: Extract<News, { type: Kind }>) => void };

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
