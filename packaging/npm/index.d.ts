/** One field of the configuration. */
export interface Field {
  name: string;
  /** Unit of the value, empty for a number without one. */
  unit: string;
  low: number;
  high: number;
  doc: string;
}

export interface About {
  version: string;
  fields: Field[];
  /** The configuration of each preset, by its name. */
  presets: Record<string, Record<string, unknown>>;
  /** Every value that `Mission.policy` may have. */
  policies: string[];
  largest: { uavs: number; cells: number };
}

/** What a person does at step `t`, counted from 1. */
export type Intervention =
  | { do: 'steer'; t: number; uav: number; motion: number }
  | { do: 'ground'; t: number; uav: number };

export interface Mission {
  policy: string;
  seed: number;
  /** Pilot density of a baseline: a number, 'min', 'mid', 'max' or 'adaptive' (default). */
  pilot?: string;
  /** Fields of the configuration over those of the preset in its field `preset`. */
  config?: Record<string, unknown>;
  /** Hotspots that are elsewhere than drawn: index, then column and row of the cell. */
  moved?: [number, [number, number]][];
  interventions?: Intervention[];
}

export interface Flight {
  /** Hash of the last state: 0x and 16 hexadecimal digits, the same on every platform. */
  state_hash: string;
  /** Detection and link along a row; `cells` is the distance in cells. */
  radar: {
    cells: number;
    low: number;
    high: number;
    quorum: number;
    link_low: boolean;
    link_high: boolean;
  }[];
  /** Trajectories of the policies that plan. */
  plans: unknown;
  /** Every step of the mission, in the form of the replay page. */
  episode: Record<string, unknown>;
}

/** The fields, presets and policies of this build. */
export function about(): About;

/** Flies a whole mission. Throws a RangeError that names the field, its value and its range. */
export function fly(mission: Mission): Flight;
