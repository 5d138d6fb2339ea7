// All text beside the map: tiles, the fleet table, the selected item, events, reward components.

const WIDEST_TABLE = 24;

// Sizes of the fleet's table, as in the style sheet.
const ROW_PX = 25;
const ROWS_SHOWN = 12;

function createTiles(list, episode) {
  const { uavCount, hotspotCount } = episode;
  const names = ['Confirmed', 'Informed', 'Flying', 'Links', 'Battery', 'Grid carbon'];
  list.innerHTML = names.map((name) => `<div><dt>${name}</dt><dd></dd></div>`).join('');
  const values = [...list.querySelectorAll('dd')];
  ['confirmed-count', 'informed-count'].forEach((id, k) => { values[k].id = id; });
  return (t) => {
    const frame = episode.frames[t];
    const intensity = frame.carbon_intensity_mg_per_kwh;
    const text = [
      `${frame.confirmed.size} <small>of ${hotspotCount}</small>`,
      `${frame.informed.size} <small>of ${hotspotCount}</small>`,
      `${uavCount - frame.grounded.size} <small>of ${uavCount}</small>`,
      `${frame.links.length}`,
      percent(episode.series.socMean[t]),
      intensity === null ? '–' : `${(intensity / 1000).toFixed(0)} <small>g/kWh</small>`,
    ];
    text.forEach((html, k) => { values[k].innerHTML = html; });
  };
}

function createFleetTable(table, episode, onSelect) {
  const { uavCount, hotspotCount, config } = episode;
  const columns =
    hotspotCount <= WIDEST_TABLE ? Array.from({ length: hotspotCount }, (_, id) => id) : [];
  const heads = columns.length
    ? columns.map((id) => `<th scope="col" title="Hotspot ${id}">H${id}</th>`).join('')
    : '<th scope="col">known</th>';
  table.innerHTML =
    '<thead><tr><th scope="col"><span class="visually-hidden">UAV</span></th>' +
    '<th scope="col">battery</th><th scope="col">pilot</th>' +
    `${heads}<th scope="col">state</th></tr></thead>` +
    `<tbody>${Array.from({ length: uavCount }, (_, id) => row(id)).join('')}</tbody>`;
  const rows = [...table.querySelectorAll('tbody tr')].map((node, id) => {
    node.addEventListener('click', () => onSelect({ uav: id }));
    return {
      node,
      button: node.querySelector('button'),
      meter: node.querySelector('.meter'),
      bar: node.querySelector('b'),
      soc: node.querySelector('.meter span'),
      swatch: node.querySelector('.swatch'),
      pilot: node.querySelector('.pilot'),
      knows: [...node.querySelectorAll('.knows')],
      count: node.querySelector('.count'),
      state: node.querySelector('.state-word'),
    };
  });
  const colour = pilotColours();
  const lowest = config.rtb_threshold_kwh / config.battery_capacity_kwh;

  function row(id) {
    const cells = columns.length
      ? columns.map(() => '<td><span class="knows" role="img"></span></td>').join('')
      : '<td class="count"></td>';
    return (
      `<tr><th scope="row"><button aria-pressed="false">UAV ${id}</button></th>` +
      '<td><span class="meter"><i><b></b></i><span></span></span></td>' +
      '<td><span class="swatch"></span><span class="pilot"></span></td>' +
      `${cells}<td class="state-word"></td></tr>`
    );
  }

  // While a mission plays, the table holds only its visible rows, since a layout of a hundred rows
  // takes longer than a frame. All rows stay while the keyboard is in the table, which would lose
  // its row.
  const scroll = table.parentElement;
  const MORE = 3;
  const whole = { first: 0, last: uavCount };
  let there = whole;
  let top = scroll.scrollTop;
  scroll.onscroll = () => { top = scroll.scrollTop; };

  function show({ first, last }) {
    if (first === there.first && last === there.last) return;
    rows.forEach(({ node }, id) => { node.hidden = id < first || id >= last; });
    table.style.margin = `${first * ROW_PX}px 0 ${(uavCount - last) * ROW_PX}px`;
    there = { first, last };
  }

  function inSight() {
    const first = Math.floor(top / ROW_PX);
    return {
      first: Math.max(0, first - MORE),
      last: Math.min(uavCount, first + ROWS_SHOWN + MORE),
    };
  }

  const behind = new Set();
  return (t, selection, changed, playing) => {
    show(playing && !table.contains(document.activeElement) ? inSight() : whole);
    if (changed) {
      writeHead(t);
      rows.forEach((_, id) => behind.add(id));
    }
    for (const id of behind) {
      if (id < there.first || id >= there.last) continue;
      write(id, t, selection);
      behind.delete(id);
    }
  };

  function writeHead(t) {
    const frame = episode.frames[t];
    table.querySelectorAll('thead th').forEach((head, k) => {
      if (columns.length && k >= 3 && k < 3 + columns.length)
        head.className = hotspotState(frame, k - 3);
    });
  }

  function write(id, t, selection) {
    const frame = episode.frames[t];
    const parts = rows[id];
    const selected = selection.uav === id;
    parts.node.classList.toggle('selected', selected);
    parts.button.setAttribute('aria-pressed', selected);
    parts.meter.classList.toggle('low', frame.soc[id] < lowest);
    parts.bar.style.width = `${100 * frame.soc[id]}%`;
    setText(parts.soc, percent(frame.soc[id]));
    const pilot = frame.pilot_density?.[id];
    parts.swatch.style.background =
      pilot === undefined ? 'var(--ring-back)' : colour(pilotShare(config, pilot));
    setText(parts.pilot, pilot === undefined ? '–' : pilot.toFixed(2));
    parts.knows.forEach((node, hotspot) => {
      const known = frame.knowledge[id].has(hotspot);
      const byAll = known && frame.informed.has(hotspot);
      const name = `knows${known ? ' yes' : ''}${byAll ? ' all' : ''}`;
      if (node.className === name && node.ariaLabel) return;
      node.className = name;
      node.setAttribute('aria-label', known ? 'knows' : 'does not know');
    });
    if (parts.count) setText(parts.count, `${frame.knowledge[id].size} of ${hotspotCount}`);
    const state = uavState(frame, id);
    setText(parts.state, state);
    parts.state.classList.toggle('alarm', state !== 'flying');
  }
}

function createInspector(card, episode, onSeek) {
  const { frames, uavCount, hotspotCount, lastStep, config } = episode;
  let shown = null;
  let charts = [];
  const facts = (pairs) => pairs.map(([name, text]) => `<dt>${name}</dt><dd>${text}</dd>`).join('');
  const list = (ids, none) => (ids.length ? ids.join(', ') : none);

  return (time, t, selection, stepChanged) => {
    const key = JSON.stringify(selection);
    if (key !== shown) rebuild(selection);
    const fresh = key !== shown;
    shown = key;
    if (stepChanged || fresh) describe(t, selection);
    for (const chart of charts) chart.update(time, t, stepChanged || fresh);
  };

  function rebuild({ uav, hotspot }) {
    const title =
      uav !== undefined ? `UAV ${uav}` : hotspot !== undefined ? `Hotspot ${hotspot}` : 'The fleet';
    card.innerHTML = `<h2>${title}</h2><dl></dl><div class="history"></div>`;
    charts = [];
    if (uav === undefined) return;
    const parent = card.querySelector('.history');
    const soc = frames.map((frame) => frame.soc[uav]);
    const pilot = frames.map((frame) => frame.pilot_density?.[uav] ?? null);
    charts = [
      {
        title: 'Battery',
        low: 0,
        high: 1,
        area: soc,
        lines: [{ values: soc }],
        format: (t) => percent(soc[t]),
      },
      {
        title: 'Pilot density',
        low: 0,
        high: config.pilot_density_max,
        area: pilot,
        lines: [{ values: pilot }],
        format: (t) => pilot[t]?.toFixed(3) ?? '–',
      },
    ].map((plan) => createChart(parent, lastStep, { ...plan, small: true }, onSeek));
  }

  function describe(t, { uav, hotspot }) {
    const frame = frames[t];
    const node = card.querySelector('dl');
    if (uav !== undefined) {
      const heard = frame.links
        .filter((link) => link.includes(uav))
        .map(([i, k]) => (i === uav ? k : i))
        .sort((a, b) => a - b);
      node.innerHTML = facts([
        ['Cell', `(${frame.positions[uav].join(', ')}), ${uavState(frame, uav)}`],
        ['Knows', list([...frame.knowledge[uav]].map((id) => `H${id}`), 'no hotspot')],
        ['Linked to', list(heard, 'nobody')],
      ]);
    } else if (hotspot !== undefined) {
      const knowers = frame.knowledge.flatMap((known, id) => (known.has(hotspot) ? [id] : []));
      const at = (step) => (step !== undefined && step <= t ? `step ${step}` : 'not yet');
      node.innerHTML = facts([
        ['Cell', `(${frame.hotspots[hotspot].join(', ')})`],
        ['Confirmed', at(episode.confirmedAt[hotspot])],
        ['Informed', at(episode.informedAt[hotspot])],
        [
          'Known to',
          knowers.length === uavCount ? `all ${uavCount} UAVs` : list(knowers, 'nobody'),
        ],
      ]);
    } else {
      const cells = episode.firstVisit.filter((visit) => visit[2] <= t).length;
      const all = config.grid_width * config.grid_height;
      node.innerHTML = facts([
        ['Moves', `${frame.moves} by the fleet`],
        ['Cells visited', `${cells} of ${all} (${percent(cells / all)})`],
        ['Returning', list([...frame.returning], 'nobody')],
        ['Grounded', list([...frame.grounded], 'nobody')],
      ]);
      card.querySelector('.history').innerHTML =
        '<p class="note">Select a UAV to see what it knows, which UAVs it hears, and the course ' +
        `of its battery and pilot density. Select one of the ${hotspotCount} hotspots to see ` +
        'which UAVs know it.</p>';
    }
  }
}

function createEventList(list, episode, onEvent) {
  list.innerHTML =
    episode.events
      .map(
        ({ t, kind, text }) =>
          `<li class="${kind}"><button><span class="when">${t}</span><span class="dot"></span>` +
          `<span>${text}</span></button></li>`,
      )
      .join('') || '<li class="note">Nothing happened.</li>';
  const items = [...list.querySelectorAll('li')];
  episode.events.forEach((event, k) =>
    items[k].firstChild.addEventListener('click', () => onEvent(event)),
  );
  let shown;
  return (t) => {
    let latest = null;
    episode.events.forEach((event, k) => {
      items[k].classList.toggle('future', event.t > t);
      items[k].classList.toggle('now', event.t === t);
      if (event.t <= t) latest = items[k];
    });
    if (latest === shown) return;
    shown = latest;
    list.scrollTop = latest ? latest.offsetTop - list.offsetTop - list.clientHeight * 0.6 : 0;
  };
}

function createRewards(list, { frames, rewardNames }) {
  const sums = { 0: rewardNames.map(() => 0) };
  for (let t = 1; t < frames.length; t += 1)
    sums[t] = rewardNames.map((name, k) => sums[t - 1][k] + frames[t].reward[name]);
  const widest = Math.max(1e-9, ...sums[frames.length - 1].map(Math.abs));
  list.innerHTML = rewardNames
    .map(
      (name) =>
        `<div><dt>${name.replace('_', ' ')}</dt><dd class="track"><b></b></dd>` +
        '<dd class="value"></dd></div>',
    )
    .join('');
  const rows = [...list.children].map((node) => ({
    bar: node.querySelector('b'),
    value: node.querySelector('.value'),
  }));
  return (t) => rows.forEach(({ bar, value }, k) => {
    const sum = sums[t][k];
    const share = Math.min(50, (50 * Math.abs(sum)) / widest);
    bar.className = sum < 0 ? 'negative' : '';
    bar.style.width = `${share}%`;
    bar.style.left = `${sum < 0 ? 50 - share : 50}%`;
    value.textContent = fixed(sum, 2);
  });
}
