// Small charts over the steps of the episode, with one cursor for all of them.

const CHART_WIDTH = 1000;
const CHART_HEIGHT = 100;

/** `plan` has the title, the read-out's format(value), low and high of the axis, and the parts to
 * draw (area, band, bars, lines, limit). */
function createChart(parent, lastStep, plan, onSeek) {
  const card = document.createElement('div');
  card.className = plan.small ? 'chart small' : 'card chart';
  card.innerHTML =
    '<header><h2></h2><output></output></header>' +
    '<div class="plot"><svg preserveAspectRatio="none" aria-hidden="true"></svg>' +
    '<span class="top"></span><span class="bottom"></span></div>';
  card.querySelector('h2').textContent = plan.title;
  card.querySelector('.top').textContent = plan.label?.(plan.high) ?? '';
  card.querySelector('.bottom').textContent = plan.label?.(plan.low) ?? '';
  if (plan.key) card.insertAdjacentHTML('beforeend', `<p class="key">${plan.key}</p>`);
  parent.append(card);

  const svg = card.querySelector('svg');
  svg.setAttribute('viewBox', `0 0 ${CHART_WIDTH} ${CHART_HEIGHT}`);
  const x = (t) => (CHART_WIDTH * t) / Math.max(1, lastStep);
  const y = (value) =>
    CHART_HEIGHT - (CHART_HEIGHT * (value - plan.low)) / (plan.high - plan.low || 1);
  const path = (values) => {
    let d = '';
    values.forEach((value, t) => {
      if (value !== null) d += `${d ? 'L' : 'M'}${x(t).toFixed(1)} ${y(value).toFixed(2)}`;
    });
    return d;
  };
  element(svg, 'path', { class: 'frame', d: `M0 ${y(Math.max(plan.low, 0))}H${CHART_WIDTH}` });
  if (plan.band) element(svg, 'path', { class: 'band', d: band(plan.band.low, plan.band.high) });
  if (plan.area)
    element(svg, 'path', {
      class: 'area',
      d: band(
        plan.area.map((v) => (v === null ? null : Math.max(plan.low, 0))),
        plan.area,
      ),
    });
  if (plan.bars)
    element(svg, 'path', {
      class: 'bars',
      d: plan.bars.map((v, t) => (v ? `M${x(t)} ${y(0)}V${y(v).toFixed(2)}` : '')).join(''),
    });
  if (plan.limit !== undefined)
    element(svg, 'path', { class: 'limit', d: `M0 ${y(plan.limit)}H${CHART_WIDTH}` });
  for (const line of plan.lines)
    element(svg, 'path', { class: `line ${line.kind ?? ''}`, d: path(line.values) });
  const mine = element(svg, 'path', { class: 'line mine' });
  const cursor = element(svg, 'line', { class: 'cursor', y1: 0, y2: CHART_HEIGHT });
  const readOut = card.querySelector('output');

  const seek = (event) => {
    const box = svg.getBoundingClientRect();
    onSeek(Math.round(lastStep * Math.min(1, Math.max(0, (event.clientX - box.left) / box.width))));
  };
  svg.addEventListener('pointerdown', (event) => {
    svg.setPointerCapture(event.pointerId);
    seek(event);
  });
  svg.addEventListener('pointermove', (event) => { if (event.buttons) seek(event); });

  return {
    update(time, t, stepChanged, uav) {
      cursor.setAttribute('x1', x(time));
      cursor.setAttribute('x2', x(time));
      if (!stepChanged) return;
      readOut.innerHTML = plan.format(t);
      mine.setAttribute('d', plan.ofUav && uav !== undefined ? path(plan.ofUav(uav)) : '');
    },
  };

  function band(low, high) {
    const there = high.map((value, t) => t).filter((t) => high[t] !== null);
    const upper = there.map((t) => `${x(t).toFixed(1)} ${y(high[t]).toFixed(2)}`);
    const lower = there.map((t) => `${x(t).toFixed(1)} ${y(low[t]).toFixed(2)}`).reverse();
    return upper.length ? `M${upper.join('L')}L${lower.join('L')}Z` : '';
  }
}

/** Formats a number with its sign in front, and a zero without a sign. */
function fixed(value, digits, plus = '') {
  const text = Math.abs(value).toFixed(digits);
  if (Number(text) === 0) return text;
  return (value < 0 ? '−' : plus) + text;
}

function createCharts(parent, episode, onSeek) {
  const { series, frames, config, lastStep } = episode;
  const small = (text) => `<small>${text}</small>`;
  const top = (values, least) => values.reduce((most, value) => Math.max(most, value ?? 0), least);
  const bottom = (values) => values.reduce((least, value) => Math.min(least, value ?? 0), 0);
  const plans = [
    {
      title: 'Battery',
      key: 'mean, least to most',
      low: 0,
      high: 1,
      label: percent,
      limit: config.rtb_threshold_kwh / config.battery_capacity_kwh,
      band: { low: series.socLow, high: series.socHigh },
      lines: [{ values: series.socMean }],
      ofUav: (id) => frames.map((frame) => frame.soc[id]),
      format: (t) => percent(series.socMean[t]),
    },
    {
      title: 'Pilot density',
      key: 'mean, least to most',
      low: 0,
      high: config.pilot_density_max,
      label: (v) => v.toFixed(2),
      band: { low: series.pilotLow, high: series.pilotHigh },
      lines: [{ values: series.pilotMean }],
      ofUav: (id) => frames.map((frame) => frame.pilot_density?.[id] ?? null),
      format: (t) => series.pilotMean[t]?.toFixed(3) ?? '–',
    },
    {
      title: 'Throughput',
      key: 'fleet mean, normalised',
      low: 0,
      high: top(series.throughput, 0.1),
      label: (v) => v.toFixed(1),
      area: series.throughput,
      lines: [{ values: series.throughput }],
      format: (t) => series.throughput[t].toFixed(2),
    },
    {
      title: 'Reward',
      key: '<b>sum</b>, <b class="bar">each step</b>',
      low: Math.min(bottom(series.rewardSum), bottom(series.reward)),
      high: top(series.rewardSum, 1),
      label: (v) => fixed(v, 0),
      bars: series.reward,
      lines: [{ values: series.rewardSum }],
      format: (t) => `${fixed(series.rewardSum[t], 1)} ${small(fixed(series.reward[t], 2, '+'))}`,
    },
    {
      title: 'CO₂',
      key: 'from charging, so far',
      low: 0,
      high: top(series.co2_g, 1),
      label: (v) => `${v.toFixed(0)} g`,
      area: series.co2_g,
      lines: [{ values: series.co2_g }],
      format: (t) => `${series.co2_g[t].toFixed(1)} ${small('g')}`,
    },
    {
      title: 'Knowledge',
      key: '<b>known</b>, <b class="confirmed">confirmed</b>, <b class="informed">informed</b>',
      low: 0,
      high: 1,
      label: percent,
      area: series.knowledge,
      lines: [
        { values: series.knowledge },
        { values: series.confirmed, kind: 'confirmed' },
        { values: series.informed, kind: 'informed' },
      ],
      format: (t) => percent(series.knowledge[t]),
    },
  ];
  return plans.map((plan) => createChart(parent, lastStep, plan, onSeek));
}
