// The mission that runs, and the person's interventions. A mission is a pure function of `mission`;
// every change runs it anew.

const ask = openKernel();
const about = await ask({ ask: 'about' });
const MOTIONS = { ArrowUp: 0, ArrowDown: 1, ArrowLeft: 2, ArrowRight: 3, '.': 4 };
/** Inputs that stand for a field of the configuration. */
const INPUTS = {
  uavs: 'uav_count',
  hotspots: 'hotspot_count',
  range: 'sensing_range_m',
  quorum: 'quorum',
  link: 'link_throughput_min',
};
/** A mission without a policy flies the default policy of its preset. */
const START = {
  preset: 'mission',
  set: {},
  policy: null,
  pilot: 'adaptive',
  seed: 1,
  moved: [],
  interventions: [],
};

let mission = structuredClone(START);
let steering = false;
let flying = null;
/** For each UAV its planned trajectories: pairs of the first step and the cells from then on. */
let plans = [];
let planLines = null;

const busy = document.createElement('p');
busy.className = 'busy';
busy.setAttribute('role', 'status');
busy.hidden = true;
document.querySelector('.stage-card').append(busy);
// What is refused is said above the map, where a phone shows it, too.
document.querySelector('main').before($('problem'));
fillChoices();
listen();
around.address = () => `m=${encodeURIComponent(JSON.stringify(difference()))}&`;
around.onKey = onMissionKey;
around.drawn = describeSelection;
addEventListener('hashchange', async () => {
  const asked = readMission();
  if (asked && JSON.stringify(asked) !== JSON.stringify(mission)) await openLink(asked);
  readAddress();
});
const opening = location.hash;
await openLink(readMission() ?? mission);
// Showing the mission replaced the address; the old address has the requested step and selection.
history.replaceState(null, '', opening || location.pathname);
readAddress();

/** The mission in the address, on top of the initial mission; undefined where there is none. */
function readMission() {
  const text = new URLSearchParams(location.hash.slice(1)).get('m');
  if (!text) return undefined;
  try {
    const asked = { ...structuredClone(START), ...JSON.parse(text) };
    const lists = [asked.moved, asked.interventions];
    if (!asked.set || typeof asked.set !== 'object' || !lists.every(Array.isArray))
      throw new Error('set must be an object, moved and interventions lists.');
    return asked;
  } catch ({ message }) {
    return { ...structuredClone(START), unreadable: message };
  }
}

/** Flies the mission of a link. If it cannot be flown, says why and flies the first scene. */
async function openLink(asked) {
  mission = asked;
  const problem = asked.unreadable ?? await fly(0);
  if (!problem) return;
  mission = structuredClone(START);
  await fly(0);
  const why = problem.replace(/\.?$/, '.');
  say(`The mission of this link cannot be flown: ${why} Here is the first scene instead.`);
}

function difference() {
  const differs = ([key, value]) => JSON.stringify(value) !== JSON.stringify(START[key]);
  return Object.fromEntries(Object.entries(mission).filter(differs));
}

function valueOf(field) {
  return mission.set?.[field] ?? about.presets[mission.preset]?.[field] ?? null;
}

function fillChoices() {
  $('scenes').replaceChildren(...about.scenes.map(({ name, summary, mission: scene }) => {
    const button = document.createElement('button');
    button.type = 'button';
    button.append(...[['b', name], ['span', summary]].map(([tag, text]) => {
      const part = document.createElement(tag);
      part.textContent = text;
      return part;
    }));
    button.addEventListener('click', () => openScene(scene));
    return button;
  }));
  const keys = [
    ['n', 'another seed'],
    ['← → ↑ ↓', 'while you steer: fly the UAV one cell'],
    ['.', 'while you steer: let the UAV stay'],
  ];
  $('keys').insertAdjacentHTML('beforeend', keys.map(([key, text]) => (
    `<dt>${key.split(' ').map((one) => `<kbd>${one}</kbd>`).join(' ')}</dt><dd>${text}</dd>`
  )).join(''));
  const options = (names) => names.map((name) => new Option(name, name));
  $('preset').replaceChildren(...options(Object.keys(about.presets)));
  $('policy').replaceChildren(...options(about.policies.map(({ name }) => name)));
  $('field').replaceChildren(...options(about.fields.map(({ name }) => name)));
  describeField();
}

function listen() {
  $('controls').addEventListener('submit', (event) => event.preventDefault());
  for (const [id, field] of Object.entries(INPUTS)) {
    $(id).addEventListener('change', () => {
      set(field, $(id).value === '' ? undefined : Number($(id).value));
    });
  }
  $('preset').addEventListener('change', () => change({ preset: $('preset').value, policy: null }));
  $('policy').addEventListener('change', () => change({ policy: $('policy').value }));
  $('pilot').addEventListener('change', () => change({ pilot: $('pilot').value.trim() }));
  $('seed').addEventListener('change', () => newSeed(Number($('seed').value)));
  $('dice').addEventListener('click', () => newSeed(mission.seed + 1));
  $('field').addEventListener('change', describeField);
  $('apply').addEventListener('click', () => set($('field').value, read($('value').value)));
  $('steer').addEventListener('click', () => takeControls(!steering));
  $('ground').addEventListener('click', ground);
  $('undo').addEventListener('click', undo);
  $('copy').addEventListener('click', () => navigator.clipboard?.writeText(location.href));
  $('stage').addEventListener('pointerdown', beginDrag);
  // While a UAV is steered, a tap is a direction and selects nothing.
  $('stage').addEventListener('click', steerByTap, { capture: true });
}

function openScene(scene) {
  mission = { ...structuredClone(START), ...structuredClone(scene) };
  takeControls(false);
  player.selection = {};
  fly(0).then((problem) => { if (!problem && !stillness.matches) setPlaying(true); });
}

function say(problem) {
  $('problem').hidden = !problem;
  $('problem').textContent = problem;
}

/** Reads a value as a person types it: a number, null, or a word. */
function read(text) {
  try {
    return JSON.parse(text);
  } catch {
    return text.trim();
  }
}

function set(field, value) {
  const fields = { ...mission.set };
  if (value === undefined) delete fields[field];
  else fields[field] = value;
  change({ set: fields });
}

/** Another seed is another mission, in which earlier interventions have no meaning. */
function newSeed(seed) {
  if (!(Number.isInteger(seed) && seed >= 0 && seed < 2 ** 32)) {
    say(`seed = ${seed}: must be a whole number from 0 to ${2 ** 32 - 1}`);
    return;
  }
  change({ seed, moved: [], interventions: [] }, 0);
}

async function change(part, time = player.time) {
  mission = { ...mission, ...part };
  await fly(time);
}

/** Runs the mission and shows it at `time`. A change during a run starts another run after it.
 * Returns why the mission cannot be flown, or ''. */
async function fly(time = player.time) {
  if (flying) { flying.again = time; return ''; }
  flying = {};
  const sign = setTimeout(() => {
    busy.textContent = 'Computing the mission …';
    busy.hidden = false;
  }, 250);
  const { preset, set: fields, policy, ...rest } = mission;
  const named = policy === null ? {} : { policy };
  let answer;
  try {
    answer = await ask({ ask: 'fly', config: { preset, ...fields }, ...named, ...rest });
  } catch (error) {
    answer = { error: error.message };
  }
  clearTimeout(sign);
  busy.hidden = true;
  const { again } = flying;
  flying = null;
  showControls();
  say(answer.error ?? '');
  if (!answer.error) show(answer, time);
  return again === undefined ? answer.error ?? '' : fly(again);
}

function show({ episode: data, radar, plans: planned }, time) {
  const { uav, hotspot } = player.selection;
  const { config, core_version: version, policy } = data.header;
  if (uav >= config.uav_count || hotspot >= config.hotspot_count) player.selection = {};
  // No command repeats what a person does.
  data.hosted ||= mission.moved.length + mission.interventions.length > 0;
  open(data);
  writeFooter(`jcas ${version}.`, 'The address holds the whole mission.');
  plans = planned;
  planLines = element($('stage'), 'path', { class: 'planned' });
  $('stage').querySelector('.tails').after(planLines);
  document.querySelector('.legend .of-plans').hidden = !plans.some((lines) => lines.length);
  const sizes = `N = ${config.uav_count}, n = ${config.hotspot_count}`;
  document.title = `${policy}, ${sizes}: jcas playground`;
  drawRadar(radar, config);
  seek(Math.min(time, episode.lastStep));
}

function showControls() {
  for (const [id, field] of Object.entries(INPUTS)) $(id).value = valueOf(field) ?? '';
  for (const id of ['preset', 'pilot', 'seed']) $(id).value = mission[id];
  const policy = mission.policy ?? about.default_policies[mission.preset];
  $('policy').value = policy;
  const described = about.policies.find(({ name }) => name === policy);
  $('policy-note').textContent = described ? `${policy}: ${described.summary}.` : '';
  [...$('scenes').children].forEach((button, index) => {
    const scene = { ...structuredClone(START), ...about.scenes[index].mission };
    button.setAttribute('aria-pressed', JSON.stringify(scene) === JSON.stringify(mission));
  });
  $('overrides').replaceChildren(...Object.entries(mission.set).map(([field, value]) => {
    const item = document.createElement('li');
    const button = document.createElement('button');
    button.type = 'button';
    button.textContent = `${field} = ${JSON.stringify(value)} ×`;
    button.setAttribute('aria-label', `Set ${field} back`);
    button.addEventListener('click', () => set(field, undefined));
    item.append(button);
    return item;
  }));
  if (document.activeElement !== $('value')) describeField();
  $('undo').disabled = !mission.interventions.length && !mission.moved.length;
}

function describeField() {
  const field = about.fields.find(({ name }) => name === $('field').value);
  $('value').value = JSON.stringify(valueOf(field.name)) ?? '';
  const range = `from ${field.low} to ${field.high}`;
  $('field-doc').textContent = `${field.doc} Unit: ${field.unit}; ${range}.`;
}

/** Shows the range of one UAV's radar, and why a quorum has to be near. */
function drawRadar(radar, config) {
  const bar = (share) => `<b style="height:${(76 * share).toFixed(1)}%"></b>`;
  const columns = radar.map(({ cells, high, quorum }) => (
    `<i>${bar(high)}${bar(quorum)}<span>${cells}</span></i>`));
  $('radar').innerHTML = columns.join('');
  const rounded = (share) => (share >= 0.095 || share === 0
    ? Math.round(100 * share)
    : (100 * share).toPrecision(1));
  const percent = (share) => `${rounded(share)} %`;
  const [here, next] = radar;
  const all = config.quorum === 1
    ? 'one alone confirms'
    : `that ${config.quorum} there all do, ${percent(here.quorum)}`;
  const reach = (key) => radar.filter((row) => row[key]).length - 1;
  const text = `Over a hotspot a UAV detects it with ${percent(here.high)} in a step; ${all}.`
    + (next ? ` One cell away it is ${percent(next.high)} and ${percent(next.quorum)}.` : '')
    + ` Links reach ${reach('link_high')} cells at the greatest pilot density`
    + ` and ${reach('link_low')} at the least.`;
  $('radar-note').textContent = text;
  $('radar').setAttribute('aria-label', text);
}

/** Draws what is planned from step t on, for the selected UAV or for all. */
function drawPlans(t) {
  const { grid_width: width, grid_height: height } = episode.config;
  const { uav } = player.selection;
  const centre = (cell) => {
    const [x, y] = [cell % width + 0.5, height - Math.floor(cell / width) - 0.5];
    return `${x * CELL} ${y * CELL}`;
  };
  const shown = uav === undefined ? plans : plans.slice(uav, uav + 1);
  planLines?.setAttribute('d', shown.map((lines) => {
    const line = lines.findLast(([first]) => first <= t);
    const cells = line ? line[1].slice(t - line[0]) : [];
    return cells.length > 1 ? `M${cells.map(centre).join('L')}` : '';
  }).join(''));
}

function describeSelection(t) {
  const { uav } = player.selection;
  drawPlans(t);
  if (steering && uav === undefined) takeControls(false);
  const state = t > 0 ? episode.frames[t] : episode.header.initial;
  $('hash').textContent = state.state_hash;
  $('steer').disabled = uav === undefined;
  $('ground').disabled = uav === undefined || t >= episode.lastStep;
  $('intervention-note').textContent = steering
    ? `UAV ${uav} is yours: an arrow key or a tap on the map flies it one cell; "." or a tap on ` +
      'its own cell lets it stay.'
    : uav !== undefined
      ? `UAV ${uav} is selected.`
      : 'Select a UAV (tap it, or press u) to steer or ground it; drag a hotspot to move it.';
}

function takeControls(on) {
  steering = on;
  $('steer').setAttribute('aria-pressed', on);
  $('stage').classList.toggle('steered', on);
  if (on) document.activeElement?.blur();
  setPlaying(false);
  describeSelection(Math.floor(player.time));
}

/** Steers toward the tapped cell, along the longer of its two distances. */
function steerByTap(event) {
  const { uav } = player.selection;
  if (!steering || uav === undefined) return;
  event.stopPropagation();
  const [x, y] = cellAt(event);
  const [ownX, ownY] = episode.frames[Math.floor(player.time)].positions[uav];
  const [dx, dy] = [x - ownX, y - ownY];
  if (dx === 0 && dy === 0) steer(MOTIONS['.']);
  else if (Math.abs(dx) > Math.abs(dy)) steer(dx > 0 ? MOTIONS.ArrowRight : MOTIONS.ArrowLeft);
  else steer(dy > 0 ? MOTIONS.ArrowUp : MOTIONS.ArrowDown);
}

/** The cell of the map under a pointer. */
function cellAt(pointer) {
  const { grid_width: width, grid_height: height } = episode.config;
  const toStage = $('stage').getScreenCTM().inverse();
  const { x, y } = new DOMPoint(pointer.clientX, pointer.clientY).matrixTransform(toStage);
  const within = (value, count) => Math.min(count - 1, Math.max(0, Math.floor(value / CELL)));
  return [within(x, width), height - 1 - within(y, height)];
}

/** Steers step t of a UAV in place of an earlier decision, and shows that step. */
function steer(motion) {
  const t = Math.floor(player.time) + 1;
  const { uav } = player.selection;
  if (uav === undefined || t > episode.config.horizon_steps) return;
  setPlaying(false);
  const isOther = (other) => other.do !== 'steer' || other.uav !== uav || other.t !== t;
  const others = mission.interventions.filter(isOther);
  change({ interventions: [...others, { do: 'steer', t, uav, motion }] }, t);
}

function ground() {
  const { uav } = player.selection;
  const t = Math.floor(player.time) + 1;
  if (uav === undefined) return;
  change({ interventions: [...mission.interventions, { do: 'ground', t, uav }] });
}

function undo() {
  if (mission.interventions.length) change({ interventions: mission.interventions.slice(0, -1) });
  else change({ moved: mission.moved.slice(0, -1) });
}

function onMissionKey(event) {
  const isTyping = /^(INPUT|SELECT|TEXTAREA|SUMMARY)$/.test(event.target.tagName);
  if (isTyping && event.target.id !== 'scrub') return true;
  if (event.key === 'n') { newSeed(mission.seed + 1); return true; }
  if (!steering || !(event.key in MOTIONS)) return false;
  event.preventDefault();
  steer(MOTIONS[event.key]);
  return true;
}

/** A hotspot follows the pointer; the mission runs with the cell where it is dropped. */
function beginDrag(event) {
  const group = event.target.closest('.hotspot');
  if (!group || steering) return;
  const stage = $('stage');
  const hotspot = Number(group.dataset.hotspot);
  const { grid_height: height } = episode.config;
  const from = `${episode.header.hotspots[hotspot]}`;
  let cell = null;

  const move = (pointer) => {
    cell = cellAt(pointer);
    group.classList.add('dragged');
    const [x, y] = [(cell[0] + 0.5) * CELL, (height - cell[1] - 0.5) * CELL];
    group.setAttribute('transform', `translate(${x} ${y})`);
  };
  const drop = () => {
    stage.removeEventListener('pointermove', move);
    if (!cell || `${cell}` === from) { group.classList.remove('dragged'); return; }
    const others = () => mission.moved.filter(([id]) => id !== hotspot);
    change({ moved: [...others(), [hotspot, cell]] }).then(() => {
      // A move to an occupied cell is refused, and the mission stays as it was.
      if (!$('problem').hidden) mission = { ...mission, moved: others() };
    });
  };
  stage.addEventListener('pointermove', move);
  addEventListener('pointerup', drop, { once: true });
}
