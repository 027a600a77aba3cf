export interface ClipEntry { id: string; name: string; file: string; take?: string | null; role: 'motion' | 'locked' }
export interface SoundEntry { id: string; name: string; file: string }
export interface Source { clips: string[]; range: [number, number] | null; laps: number }
export type PenPoint = [number, number, number | null, number | null];

export type Control =
  | { kind: 'curve'; strokes: PenPoint[][]; timing: 'pen' | 'even'; smooth: number | null }
  | { kind: 'wave'; expression: string }
  | { kind: 'drawnWave'; points: [number, number][] }
  | { kind: 'labels'; segments: LabelSegment[] }
  | { kind: 'sound'; sound: string; smooth: number | null; outline: boolean }
  | { kind: 'motion'; clip: string };
export interface LabelSegment { name: string; seconds: number; colour?: string | null }

export type Place =
  | { kind: 'time'; seconds: number }
  | { kind: 'point'; point: [number, number] }
  | { kind: 'value'; value: number }
  | { kind: 'label'; label: string };
export type KeyKind = 'soft' | 'hard' | 'avoid' | 'never' | 'fixed';
export interface Key {
  id: string;
  enabled: boolean;
  kind: KeyKind;
  place: Place | null;
  pose: { clip: string; frame: number } | null;
  weight: number | null;
  distance: number | null;
  radius: number | null;
  fixed: { clip: string; from: number; to: number } | null;
}

export type Path =
  | { kind: 'straight' }
  | { kind: 'arc'; degrees: number }
  | { kind: 'bend'; degrees: number }
  | { kind: 'drawn'; points: [number, number][]; closed: boolean; metresPerUnit: number | null };
export interface Settings {
  preset: 'follow' | 'natural';
  structure: number | null;
  evenness: number | null;
  blend: number | null;
  seed: number;
  mirror: boolean;
  loop: boolean;
  length: number | null;
  repeat: number;
  fps: number | null;
  solution: number;
  root: 'travel' | 'inPlace' | 'bone' | 'hips';
  path: Path | null;
}

export interface Document {
  name: string;
  clips: ClipEntry[];
  sounds: SoundEntry[];
  source: Source;
  control: Control | null;
  keys: Key[];
  settings: Settings;
  page: Record<string, unknown>;
}

export interface HistoryLabels { undo: string[]; redo: string[] }
export interface ProjectState { revision: number; document: Document; history: HistoryLabels; result: string | null; job: JobState | null }
export interface Applied { revision: number; history: HistoryLabels }

export type Command =
  | { type: 'setName'; name: string }
  | { type: 'setSource'; source: Source }
  | { type: 'setControl'; control: Control | null }
  | { type: 'setSettings'; settings: Settings }
  | { type: 'setPage'; page: Record<string, unknown> }
  | { type: 'putKey'; key: Key }
  | { type: 'removeKey'; id: string }
  | { type: 'setKeys'; keys: Key[] }
  | { type: 'renameClip'; id: string; name: string }
  | { type: 'removeClip'; id: string }
  | { type: 'removeSound'; id: string }
  | { type: 'clear' };

export interface JobState {
  id: string;
  kind: string;
  state: 'running' | 'done' | 'cancelled' | 'failed';
  level: number;
  levels: number;
  done: number;
  total: number;
  result: string | null;
  results: string[];
  error: string | null;
}

export interface Info {
  version: string;
  lan: boolean;
  formats: { extension: string; name: string; read: boolean; write: boolean }[];
  samples: { name: string; kind: 'motion' | 'curve'; description: string }[];
  limits: Record<string, number>;
}

export interface ClipInfo {
  id: string;
  name: string;
  file: string;
  take: string | null;
  takes: string[];
  format: string;
  frames: number;
  frameRate: number;
  seconds: number;
  joints: number;
  role: 'motion' | 'locked';
  hasSkin: boolean;
}
export interface Joint { name: string; parent: number; offset: [number, number, number]; endSite: boolean; hidden: boolean }
export interface SkeletonInfo { joints: Joint[]; travelJoint: number; height: number }
export interface LimbInfo { from: number; to: number; fromRadius: number; toRadius: number; side: 'left' | 'right' | 'middle' }
export interface Finding { severity: 'info' | 'warning' | 'error'; message: string }
export interface ClipDetail extends ClipInfo {
  skeleton: SkeletonInfo;
  limbs: LimbInfo[];
  findings: Finding[];
  restPoseFrames: number;
}
export interface Added { clips: ClipInfo[]; revision: number; history: HistoryLabels; warnings: string[]; control?: Control }

export interface Gauge { name: string; value: number; baseline: number | null; good: number; verdict: 'good' | 'fair' | 'poor'; text: string }
export interface Result {
  id: string;
  revision: number;
  kind: 'align' | 'retarget';
  frames: number;
  frameRate: number;
  seconds: number;
  clipForSkeleton: string;
  loop: boolean;
  used: { rate: number; clip: string[]; frame: number[]; confidence: number[] };
  gauges: Gauge[];
  badFrames: { jump: number[]; slide: number[]; freeze: number[] };
  keys: { id: string; kind: string; seconds: number; distance: number | null; met: 'good' | 'fair' | 'poor' }[];
  mirrorSymmetry: number;
  ambiguous: boolean;
  notes: string[];
  objective: number | null;
  distance: number | null;
  report: unknown;
}

export interface Candidate { clip: string; frame: number; seconds: number; share: number; radius: number; x: number; y: number }
export interface Suggestions { candidates: Candidate[]; map: { frames: { clip: string; frame: number; x: number; y: number }[]; stress: number } }
