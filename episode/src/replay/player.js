// Time, selection and keys; this file calls all drawing.

const STEPS_PER_SECOND = 2.5;
const $ = (id) => document.getElementById(id);
/** The presets, and the policies that fly the same in every program. */
const KNOWN = JSON.parse($('presets').textContent);

let episode = null;
let parts = {};
const player = {
  time: 0,
  playing: false,
  selection: {},
  drawnStep: -1,
  drawnSelection: null,
  clock: 0,
};
const stillness = matchMedia('(prefers-reduced-motion: reduce)');
/** A page around the player may add keys, words in the address, and a callback after drawing. */
const around = { onKey: () => false, address: () => '', drawn: () => {} };

$('scrub').addEventListener('input', () => seek(Number($('scrub').value)));
$('first').onclick = () => seek(0);
$('back').onclick = () => stepBy(-1);
$('play').onclick = playOrPause;
$('forward').onclick = () => stepBy(1);
$('last').onclick = () => seek(episode.lastStep);
$('help-open').onclick = () => $('help').showModal();
// Otherwise the closed dialog's button may keep the focus and intercept the space key.
$('help').addEventListener('close', () => document.activeElement?.blur());
addEventListener('keydown', onKey);
if (JSON.parse($('episode').textContent)) {
  open(JSON.parse($('episode').textContent));
  addEventListener('hashchange', readAddress);
  readAddress();
}

/** Shows an episode in place of the previous one. */
function open(data) {
  episode = readEpisode(data);
  for (const id of [
    'stage',
    'event-lane',
    'tiles',
    'charts',
    'fleet',
    'inspector',
    'events',
    'rewards',
  ])
    $(id).replaceChildren();
  parts = {
    stage: createStage($('stage'), episode, toggle),
    tiles: createTiles($('tiles'), episode),
    fleet: createFleetTable($('fleet'), episode, toggle),
    inspector: createInspector($('inspector'), episode, seek),
    events: createEventList($('events'), episode, goToEvent),
    rewards: createRewards($('rewards'), episode),
    charts: createCharts($('charts'), episode, seek),
  };
  writeHeader();
  drawEventLane();
  $('scrub').max = episode.lastStep;
  [player.drawnStep, player.drawnSelection] = [-1, null];
}

function writeHeader() {
  const { header, end, uavCount, hotspotCount, lastStep, frames, config } = episode;
  const plural = (count, word) => `${count} ${word}${count === 1 ? '' : 's'}`;
  $('headline').textContent =
    `${plural(uavCount, 'UAV')} search for ${plural(hotspotCount, 'hotspot')}`;
  $('byline').textContent =
    `policy ${header.policy}, pilot density ${header.pilot}, seed ${shortSeed(header.seed)}, ` +
    `quorum ${config.quorum}, ` +
    `${config.grid_width} × ${config.grid_height} cells of ${config.cell_size_m} m`;
  $('result').textContent = end.terminated
    ? `Complete in ${plural(lastStep, 'step')}`
    : `${frames[lastStep].informed.size} of ${hotspotCount} informed after ` +
      plural(lastStep, 'step');
  $('result').className = `badge ${end.terminated ? 'success' : 'failure'}`;
  $('pilot-low').textContent = config.pilot_density_min.toFixed(2);
  $('pilot-high').textContent = config.pilot_density_max.toFixed(2);
  writeLegend();
  const recorded = `Recorded by jcas ${header.core_version}.`;
  writeFooter(recorded, 'The page is one file and loads nothing.');
}

/** Says which configuration was flown, and by which command, where one has these settings. */
function writeFooter(before, after) {
  const { header, hosted, config } = episode;
  const { preset, changed } = nearestPreset(config);
  const words = changed.map(([name, value]) => `${name} = ${JSON.stringify(value)}`).join(', ');
  const named = `Preset ${preset}${words && ` with ${words}`}`;
  const flown = `${named}, configuration ${header.config_hash}.`;
  $('footer').textContent = `${before} ${flown} ${after} Press ? for the keys.`;
  if (hosted || !KNOWN.baselines.includes(header.policy)) return;
  const settings = changed.map(([name, value]) => [
    '--set', quoted(`${name}=${typeof value === 'string' ? value : JSON.stringify(value)}`),
  ]);
  const command = [
    'jcas', 'replay', '--preset', preset, ...settings.flat(), '--policy', header.policy,
    '--pilot', quoted(header.pilot), '--episode-seed', shortSeed(header.seed),
  ];
  const code = document.createElement('code');
  code.textContent = command.join(' ');
  const line = document.createElement('p');
  line.append('Command for these settings: ', code);
  $('footer').append(line);
}

/** The preset with the fewest other values, and the fields that differ from it. */
function nearestPreset(config) {
  const { first, presets } = KNOWN;
  const ranked = Object.entries(presets).map(([preset, fields]) => {
    const whole = { ...presets[first], ...fields };
    const differs = ([name, value]) => JSON.stringify(value) !== JSON.stringify(whole[name]);
    return { preset, changed: Object.entries(config).filter(differs) };
  });
  return ranked.reduce((best, one) => (one.changed.length < best.changed.length ? one : best));
}

/** A word as a shell takes it. */
function quoted(word) {
  return /^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`;
}

/** The legend has what this episode draws. */
function writeLegend() {
  const { frames, lastStep, config, searchedAt } = episode;
  const lowest = config.rtb_threshold_kwh / config.battery_capacity_kwh;
  const drawn = {
    'of-alarms': frames[lastStep].false_alarms,
    'of-reports': frames[lastStep].reports,
    'of-searched': searchedAt,
    'of-plans': false,
    'of-low': frames.some((frame) => frame.soc.some((soc) => soc < lowest)),
    'of-returning': frames.some((frame) => frame.returning.size),
    'of-grounded': frames.some((frame) => frame.grounded.size),
  };
  for (const [key, is] of Object.entries(drawn)) {
    for (const node of document.querySelectorAll(`.legend .${key}`)) node.hidden = !is;
  }
}

/** A small seed is shown in decimal, as people type it; a derived one as in the trace. */
function shortSeed(hex) {
  const seed = BigInt(hex);
  return seed < 1_000_000n ? `${seed}` : `0x${seed.toString(16)}`;
}

/** One lane of marks above the slider; events of the same step are stacked. */
function drawEventLane() {
  const lane = $('event-lane');
  lane.setAttribute('viewBox', '0 0 1000 24');
  const stacked = new Map();
  for (const event of episode.events.filter(({ kind }) => kind !== 'returning')) {
    const row = stacked.get(event.t) ?? 0;
    stacked.set(event.t, row + 1);
    // The slider's thumb is about 16 px wide, so its centre runs from 8 px to 8 px before the end.
    const x = 1000 * (0.012 + 0.976 * (event.t / Math.max(1, episode.lastStep)));
    const mark = element(lane, 'path', {
      class: `mark ${event.kind}`,
      d: `M${x} ${19 - Math.min(row, 2) * 7.5}h0.01`,
    });
    mark.addEventListener('click', () => goToEvent(event));
  }
}

function seek(time) {
  player.time = Math.min(episode.lastStep, Math.max(0, time));
  if (player.time === episode.lastStep) setPlaying(false);
  draw();
}

function stepBy(count) {
  setPlaying(false);
  seek(Math.floor(player.time) + count);
}

function goToEvent(event) {
  if (event.pick) player.selection = event.pick;
  setPlaying(false);
  seek(event.t);
}

function nextEvent(direction) {
  const t = Math.floor(player.time);
  const ahead = episode.events.filter((event) => (direction > 0 ? event.t > t : event.t < t));
  if (ahead.length) stepBy(ahead.at(direction > 0 ? 0 : -1).t - t);
}

function toggle(pick) {
  const same = JSON.stringify(pick) === JSON.stringify(player.selection);
  player.selection = same ? {} : pick;
  draw();
}

function selectNext(kind, count, direction) {
  const now = player.selection[kind] ?? (direction > 0 ? -1 : 0);
  player.selection = { [kind]: (now + direction + count) % count };
  draw();
}

function setPlaying(playing) {
  if (playing === player.playing) return;
  player.playing = playing;
  $('play').classList.toggle('playing', playing);
  $('play').setAttribute('aria-label', playing ? 'Pause' : 'Play');
  // A screen reader could not keep up with a sentence for each step.
  $('caption').setAttribute('aria-live', playing ? 'off' : 'polite');
  if (!playing) return writeAddress();
  if (player.time >= episode.lastStep) player.time = 0;
  player.clock = performance.now();
  requestAnimationFrame(tick);
}

/** A pause moves to the nearest step, so that the page always shows a step of the trace. */
function playOrPause() {
  const wasPlaying = player.playing;
  setPlaying(!wasPlaying);
  if (wasPlaying) seek(Math.round(player.time));
}

function tick(now) {
  if (!player.playing) return;
  const elapsed_s = Math.max(0, now - player.clock) / 1000;
  player.clock = now;
  player.time = Math.min(
    episode.lastStep,
    player.time + elapsed_s * STEPS_PER_SECOND * Number($('speed').value),
  );
  if (player.time === episode.lastStep) setPlaying(false);
  draw();
  requestAnimationFrame(tick);
}

function changeSpeed(direction) {
  const speed = $('speed');
  speed.selectedIndex = Math.min(speed.length - 1, Math.max(0, speed.selectedIndex + direction));
}

function draw() {
  const t = Math.floor(player.time);
  const { selection } = player;
  const selectionKey = JSON.stringify(selection);
  const changed = t !== player.drawnStep || selectionKey !== player.drawnSelection;
  parts.stage.draw(stillness.matches ? t : player.time, selection, changed);
  for (const chart of parts.charts) chart.update(player.time, t, changed, selection.uav);
  parts.inspector(player.time, t, selection, changed);
  parts.fleet(t, selection, changed, player.playing);
  if (!changed) return;
  for (const node of document.querySelectorAll('.legend .of-selection'))
    node.hidden = selection.uav === undefined ||
      (node.classList.contains('of-alarms') && !episode.frames[episode.lastStep].false_alarms);
  parts.tiles(t);
  parts.events(t);
  parts.rewards(t);
  $('scrub').value = t;
  $('scrub').setAttribute('aria-valuetext', `step ${t} of ${episode.lastStep}`);
  const elapsed = clockTime(t * episode.config.step_duration_s);
  $('step-label').innerHTML = `Step ${t} <small>of ${episode.lastStep}, ${elapsed}</small>`;
  $('caption').textContent = caption(t);
  [player.drawnStep, player.drawnSelection] = [t, selectionKey];
  if (!player.playing) writeAddress();
  around.drawn(t);
}

function clockTime(seconds) {
  const whole = Math.round(seconds);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, '0')} min`;
}

function caption(t) {
  const now = episode.events.filter((event) => event.t === t).map((event) => event.text);
  if (now.length)
    return `${now.slice(0, 4).join('. ')}${now.length > 4 ? `, and ${now.length - 4} more` : ''}.`;
  if (t === 0) return 'The fleet stands at its start. Press space to play.';
  const frame = episode.frames[t];
  return (
    `${frame.confirmed.size} of ${episode.hotspotCount} hotspots confirmed, ` +
    `${frame.informed.size} known to every UAV.`
  );
}

/** The address has the form `#t=12&uav=3` or `#t=12&hotspot=1`. */
function readAddress() {
  const parameters = new URLSearchParams(location.hash.slice(1));
  const number = (name, limit) => {
    const value = parameters.has(name) ? Number(parameters.get(name)) : NaN;
    return Number.isInteger(value) && value >= 0 && value < limit ? value : undefined;
  };
  const [uav, hotspot] = [number('uav', episode.uavCount), number('hotspot', episode.hotspotCount)];
  player.selection = uav !== undefined ? { uav } : hotspot !== undefined ? { hotspot } : {};
  setPlaying(false);
  seek(number('t', episode.lastStep + 1) ?? 0);
  // A page that is opened without a step plays by itself.
  if (!parameters.has('t') && !stillness.matches) setPlaying(true);
}

function writeAddress() {
  const picked = Object.entries(player.selection).map(([name, id]) => `&${name}=${id}`).join('');
  try {
    history.replaceState(null, '', `#${around.address()}t=${Math.floor(player.time)}${picked}`);
  } catch {
    // Some viewers forbid changing the address; the page works without it.
  }
}

function onKey(event) {
  if (event.ctrlKey || event.altKey || event.metaKey || $('help').open) return;
  const tag = event.target.tagName;
  if (tag === 'SELECT' || (event.key === ' ' && (tag === 'BUTTON' || tag === 'INPUT'))) return;
  if (!episode || around.onKey(event)) return;
  const stride = event.shiftKey ? 10 : 1;
  const back = event.shiftKey ? -1 : 1;
  const actions = {
    ' ': playOrPause,
    ArrowLeft: () => stepBy(-stride),
    ArrowRight: () => stepBy(stride),
    Home: () => { setPlaying(false); seek(0); },
    End: () => seek(episode.lastStep),
    '[': () => nextEvent(-1),
    ']': () => nextEvent(1),
    '+': () => changeSpeed(1),
    '=': () => changeSpeed(1),
    '-': () => changeSpeed(-1),
    '?': () => $('help').showModal(),
    u: () => selectNext('uav', episode.uavCount, back),
    h: () => selectNext('hotspot', episode.hotspotCount, back),
    Escape: () => { player.selection = {}; draw(); },
  };
  const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
  if (!action) return;
  event.preventDefault();
  action();
}
