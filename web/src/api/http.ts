/** What the server answers when it cannot do a thing: what is wrong, and what to do. */
export class Refused extends Error {
  readonly code: string;
  readonly hint: string | null;

  constructor(code: string, message: string, hint: string | null) {
    super(message);
    this.code = code;
    this.hint = hint;
  }
}

const BASE = new URL('api/', document.baseURI);

export function address(path: string): URL {
  return new URL(path, BASE);
}

export async function get<T>(path: string): Promise<T> {
  return (await answer(path, {})).json() as Promise<T>;
}

export async function bytes(path: string): Promise<ArrayBuffer> {
  return (await answer(path, {})).arrayBuffer();
}

export async function post<T>(path: string, body: unknown): Promise<T> {
  return (await postFor(path, body)).json() as Promise<T>;
}

/** As `post`, for answers that are no JSON. */
export function postFor(path: string, body: unknown): Promise<Response> {
  return answer(path, { method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(body) });
}

/** Puts something in place of what is there. */
export async function put(path: string, body: unknown): Promise<void> {
  await answer(path, { method: 'PUT', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(body) });
}

export async function upload<T>(path: string, file: Blob): Promise<T> {
  const headers = { 'Content-Type': 'application/octet-stream' };
  return (await answer(path, { method: 'POST', headers, body: file })).json() as Promise<T>;
}

export async function remove<T>(path: string): Promise<T> {
  return (await answer(path, { method: 'DELETE', headers: { 'Content-Type': 'application/json' } })).json() as Promise<T>;
}

async function answer(path: string, init: RequestInit): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(address(path), init);
  } catch {
    throw new Refused('unreachable', 'The studio does not answer.', 'Is the program still running in its terminal?');
  }
  if (!response.ok) throw await refusal(response);
  return response;
}

async function refusal(response: Response): Promise<Refused> {
  try {
    const { error } = (await response.json()) as { error: { code: string; message: string; hint: string | null } };
    return new Refused(error.code, error.message, error.hint);
  } catch {
    return new Refused(`status_${response.status}`, `The studio answered ${response.status} ${response.statusText}.`, null);
  }
}
