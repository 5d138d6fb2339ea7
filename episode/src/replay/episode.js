// The episode in the page's form: frame 0 is the start, frame t the state after step t.

const MICROJOULES_PER_KWH = 3.6e12;
const NANOGRAMS_PER_GRAM = 1e9;

function readEpisode({ header, steps, end, hosted = false, footprint_cells: footprint }) {
  const { config, initial } = header;
  const capacity_uj = config.battery_capacity_kwh * MICROJOULES_PER_KWH;
  const nobody = initial.positions.map(() => []);
  const start = {
    t: 0,
    positions: initial.positions,
    pilot_density: null,
    battery_uj: initial.battery_uj,
    grounded: [],
    returning: [],
    links: [],
    knowledge: nobody,
    confirmed: [],
    informed: [],
    carbon_intensity_mg_per_kwh: null,
    co2_ng: 0,
    throughput: 0,
    reward: {},
  };
  let hotspots = header.hotspots;
  const frames = [start, ...steps].map((step) => ({
    ...step,
    hotspots: (hotspots = moved(hotspots, step.moved_hotspots)),
    soc: step.battery_uj.map((uj) => uj / capacity_uj),
    grounded: new Set(step.grounded),
    returning: new Set(step.returning),
    knowledge: step.knowledge.map((ids) => new Set(ids)),
    confirmed: new Set(step.confirmed),
    informed: new Set(step.informed),
    co2_g: step.co2_ng / NANOGRAMS_PER_GRAM,
    reward_total: Object.values(step.reward).reduce((sum, part) => sum + part, 0),
  }));

  const episode = {
    header, end, config, frames, footprint, hosted,
    uavCount: initial.positions.length,
    hotspotCount: header.hotspots.length,
    lastStep: frames.length - 1,
    rewardNames: Object.keys(steps[0]?.reward ?? {}),
  };
  for (const frame of frames) frame.knownBy = countKnowers(episode, frame);
  countMoves(frames);
  episode.firstVisit = firstCells(frames, (frame) => frame.positions);
  episode.firstFalse = firstCells(frames, (frame) => frame.falsely_confirmed ?? []);
  episode.searchedAt = firstSearches(episode);
  episode.confirmedAt = firstSteps(frames, episode.hotspotCount, (frame) => frame.confirmed);
  episode.informedAt = firstSteps(frames, episode.hotspotCount, (frame) => frame.informed);
  episode.series = readSeries(episode);
  episode.events = readEvents(episode);
  return episode;
}

/** The cells of the hotspots after a host's moves; the same array where it has moved none. */
function moved(hotspots, moves = []) {
  const now = new Map(moves);
  return now.size ? hotspots.map((cell, id) => now.get(id) ?? cell) : hotspots;
}

/** The number of UAVs that know each hotspot. */
function countKnowers({ hotspotCount }, frame) {
  const count = new Array(hotspotCount).fill(0);
  for (const known of frame.knowledge) for (const hotspot of known) count[hotspot] += 1;
  return count;
}

/** The number of moves of the whole fleet up to each frame. */
function countMoves(frames) {
  frames[0].moves = 0;
  for (let t = 1; t < frames.length; t += 1) {
    const before = frames[t - 1].positions;
    const moved = frames[t].positions.filter(
      ([x, y], id) => x !== before[id][0] || y !== before[id][1],
    );
    frames[t].moves = frames[t - 1].moves + moved.length;
  }
}

/** The step at which each id is first in a frame's set; undefined when it never is. */
function firstSteps(frames, count, setOf) {
  const at = new Array(count).fill(undefined);
  frames.forEach((frame, t) => { for (const id of setOf(frame)) at[id] ??= t; });
  return at;
}

/** [x, y, first step] of every cell that a frame's list ever holds. */
function firstCells(frames, listOf) {
  const seen = new Map();
  frames.forEach((frame, t) => {
    for (const [x, y] of listOf(frame)) {
      const key = `${x},${y}`;
      if (!seen.has(key)) seen.set(key, [x, y, t]);
    }
  });
  return [...seen.values()];
}

/** For each UAV, the step from which it knows that a cell has been searched, row by row from below.
 * A value is Infinity where it never knows; the result is null without search maps. The computation
 * needs only positions, grounded UAVs and links. */
function firstSearches({ config, frames, uavCount }) {
  if (config.search_maps !== 'shared') return null;
  const [width, height] = [config.grid_width, config.grid_height];
  const squared = (config.search_map_radius_m / config.cell_size_m) ** 2;
  const at = Array.from({ length: uavCount }, () =>
    new Float64Array(width * height).fill(Infinity),
  );
  for (let t = 1; t < frames.length; t += 1) {
    const { positions, grounded, links } = frames[t];
    positions.forEach(([px, py], id) => {
      if (grounded.has(id)) return;
      for (let cell = 0; cell < width * height; cell += 1) {
        const [dx, dy] = [(cell % width) - px, Math.floor(cell / width) - py];
        if (dx * dx + dy * dy <= squared) at[id][cell] = Math.min(at[id][cell], t);
      }
    });
    const leader = at.map((_, id) => id);
    const find = (id) => { while (leader[id] !== id) id = leader[id]; return id; };
    for (const [i, k] of links) leader[find(i)] = find(k);
    const known = new Map();
    at.forEach((map, id) => {
      const root = find(id);
      if (!known.has(root)) known.set(root, new Set());
      map.forEach((since, cell) => { if (since <= t) known.get(root).add(cell); });
    });
    at.forEach((map, id) => {
      for (const cell of known.get(find(id))) map[cell] = Math.min(map[cell], t);
    });
  }
  return at;
}

function readSeries({ frames, uavCount, hotspotCount }) {
  const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;
  const least = (values) => values.reduce((a, b) => Math.min(a, b));
  const most = (values) => values.reduce((a, b) => Math.max(a, b));
  const pilots = frames.map((frame) => frame.pilot_density);
  const ofPilot = (statistic) => pilots.map((values) => (values ? statistic(values) : null));
  let sum = 0;
  return {
    socMean: frames.map((f) => mean(f.soc)),
    socLow: frames.map((f) => least(f.soc)),
    socHigh: frames.map((f) => most(f.soc)),
    pilotMean: ofPilot(mean),
    pilotLow: ofPilot(least),
    pilotHigh: ofPilot(most),
    throughput: frames.map((f) => f.throughput),
    reward: frames.map((f) => f.reward_total),
    rewardSum: frames.map((f) => (sum += f.reward_total)),
    co2_g: frames.map((f) => f.co2_g),
    knowledge: frames.map((f) => f.knownBy.reduce((a, b) => a + b, 0) / (uavCount * hotspotCount)),
    confirmed: frames.map((f) => f.confirmed.size / hotspotCount),
    informed: frames.map((f) => f.informed.size / hotspotCount),
  };
}

/** A UAV that charges just above the threshold and falls below it again is on the same return. */
const SAME_RETURN_STEPS = 10;

/** The events in the order of their steps; `kind` is also the class that colours an event. */
function readEvents({ frames, end, lastStep, hotspotCount, uavCount }) {
  const events = [];
  const lastReturning = new Array(uavCount).fill(-Infinity);
  for (let t = 1; t < frames.length; t += 1) {
    const [before, now] = [frames[t - 1], frames[t]];
    const entering = (name) => [...now[name]].filter((id) => !before[name].has(id));
    for (const id of entering('confirmed'))
      events.push({ t, kind: 'confirmed', text: `Hotspot ${id} confirmed`, pick: { hotspot: id } });
    for (const id of entering('informed'))
      events.push({
        t,
        kind: 'informed',
        text: `Hotspot ${id} known to all`,
        pick: { hotspot: id },
      });
    const leaving = entering('returning').filter((id) => t - lastReturning[id] > SAME_RETURN_STEPS);
    for (const id of now.returning) lastReturning[id] = t;
    for (const id of leaving)
      events.push({ t, kind: 'returning', text: `UAV ${id} returns to base`, pick: { uav: id } });
    for (const id of entering('grounded'))
      events.push({ t, kind: 'grounded', text: `UAV ${id} grounded`, pick: { uav: id } });
  }
  const informed = frames[lastStep].informed.size;
  if (end.terminated) events.push({ t: lastStep, kind: 'end', text: 'Mission complete' });
  else if (end.truncated)
    events.push({
      t: lastStep,
      kind: 'end',
      text: `Horizon reached, ${informed} of ${hotspotCount} informed`,
    });
  return events;
}
