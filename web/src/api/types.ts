// Names for what the program says and hears. The types themselves are generated from its description (`schema.ts`).

import type { components } from './schema';

type Schemas = components['schemas'];

/** With all its fields, as the program sends it; only what is sent to the program may leave some out. */
type Whole<T> = T extends object ? { [K in keyof T]-?: Whole<T[K]> } : T;

export type ClipEntry = Whole<Schemas['ClipEntry']>;
export type SoundEntry = Whole<Schemas['SoundEntry']>;
export type Source = Whole<Schemas['Source']>;
export type Control = Whole<Schemas['Control']>;
export type PenPoint = Extract<Control, { kind: 'curve' }>['strokes'][number][number];
export type LabelSegment = Whole<Schemas['LabelSegment']>;
export type Place = Whole<Schemas['Place']>;
export type KeyKind = Schemas['KeyKind'];
export type Key = Whole<Schemas['Key']>;
export type Path = Whole<Schemas['GroundPath']>;
export type Settings = Whole<Schemas['Settings']>;
export type Document = Whole<Schemas['Document']>;
export type Command = Whole<Schemas['Command']>;

export type HistoryLabels = Whole<Schemas['HistoryState']>;
export type ProjectState = Whole<Schemas['ProjectState']>;
export type Applied = Whole<Schemas['Applied']>;
export type JobState = Whole<Schemas['JobState']>;
export type Event = Whole<Schemas['Event']>;

export type Info = Whole<Schemas['Info']>;
export type ClipInfo = Whole<Schemas['ClipInfo']>;
export type SkeletonInfo = Whole<Schemas['SkeletonInfo']>;
export type LimbInfo = Whole<Schemas['LimbInfo']>;
export type ClipDetail = Whole<Schemas['ClipDetail']>;
export type Added = Whole<Schemas['Added']>;
export type SoundAdded = Whole<Schemas['SoundAdded']>;
export type Outline = Whole<Schemas['Outline']>;
export type DrawingRead = Whole<Schemas['DrawingRead']>;
export type WaveSeen = Whole<Schemas['WaveSeen']>;

export type Gauge = Whole<Schemas['Gauge']>;
export type Result = Whole<Schemas['ResultFacts']>;
export type Figure = Whole<Schemas['Figure']>;
export type Candidate = Whole<Schemas['Suggestion']>;
export type Suggestions = Whole<Schemas['Suggestions']>;
export type Certificate = Whole<Schemas['CertificateFacts']>;
export type RetargetDone = Whole<Schemas['RetargetDone']>;
export type CommandLine = Whole<Schemas['CommandLine']>;
export type Bake = Whole<Schemas['Bake']>;

export type BoardState = Whole<Schemas['BoardState']>;
export type MadeFrame = Whole<Schemas['MadeFrame']>;
export type MadeTake = Whole<Schemas['MadeTake']>;
export type BoardMade = Whole<Schemas['BoardMade']>;

/** What is sent, where a part may be left out. */
export type ExportAsked = Schemas['ExportAsked'];
export type RetargetAsked = Schemas['RetargetAsked'];

export type FromPage = Schemas['FromPage'];
export type ToPage = Whole<Schemas['ToPage']>;
export type StrokeMode = Schemas['StrokeMode'];
