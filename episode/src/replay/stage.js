// The map: the objects on the grid at a moment between two steps.

const CELL = 40;
/** The smallest text on the screen. */
const READABLE_PX = 11;
/** The largest font of a name that its UAV's disc has room for. */
const WIDEST_NAME = 16;
const SVG = 'http://www.w3.org/2000/svg';

function element(parent, name, attributes = {}) {
  const node = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  parent.append(node);
  return node;
}

/** Writes only changed values, since each write causes a new layout. */
function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

function createStage(svg, episode, onSelect) {
  const { config, header, uavCount } = episode;
  const [width, height] = [config.grid_width * CELL, config.grid_height * CELL];
  const glyph = CELL * Math.max(1, Math.max(config.grid_width, config.grid_height) / 26);
  const margin = glyph * 0.55;
  const colour = pilotColours(config);
  const centre = ([x, y]) => [(x + 0.5) * CELL, height - (y + 0.5) * CELL];
  const edge = glyph * 0.25;
  const view = [-margin, -edge, width + margin + edge, height + margin + edge];
  svg.setAttribute('viewBox', view.join(' '));

  drawField();
  const searched = drawSearched();
  const reported = drawReported();
  const visited = episode.firstVisit.map(([x, y, t]) => {
    const [cx, cy] = centre([x, y]);
    return {
      t,
      node: element(svg, 'rect', {
        class: 'visited',
        x: cx - CELL / 2 + 0.5,
        y: cy - CELL / 2 + 0.5,
        width: CELL - 1,
        height: CELL - 1,
      }),
    };
  });
  header.depots.forEach(drawDepot);
  const falsely = episode.firstFalse.map(([x, y, t]) => {
    const title = `No hotspot at (${x},${y}): falsely confirmed in step ${t}`;
    return { t, node: drawCross('falsely', [x, y], 12, title) };
  });
  const hotspots = header.hotspots.map(drawHotspot);
  const alarms = element(svg, 'path', { class: 'alarms' });
  const footprint = element(svg, 'circle', { class: 'footprint', r: 0 });
  const tails = element(svg, 'path', { class: 'tails' });
  const route = element(svg, 'path', { class: 'route' });
  const links = element(svg, 'path', { class: 'links' });
  const ownLinks = element(svg, 'path', { class: 'links mine' });
  const fleet = element(svg, 'g');
  const uavs = Array.from({ length: uavCount }, (_, id) => drawUav(id));
  const tags = header.hotspots.map(drawTag);
  const counts = element(svg, 'g', { class: 'counts' });
  const layouts = episode.frames.map(() => null);
  let placedHotspots = header.hotspots;
  /** Units of the map in a pixel of the screen. */
  let unitsPerPx = 1;
  /** What drawStep has drawn last. */
  let lastStep = null;
  fit();
  // The observer of an earlier episode in the same picture ends with its first call.
  const observer = new ResizeObserver(() => (fleet.isConnected ? fit() : observer.disconnect()));
  observer.observe(svg);

  return { draw };

  function drawField() {
    element(svg, 'rect', { class: 'field', width, height, rx: 3 });
    let lines = '';
    for (let x = 1; x < config.grid_width; x += 1) lines += `M${x * CELL} 0V${height}`;
    for (let y = 1; y < config.grid_height; y += 1) lines += `M0 ${y * CELL}H${width}`;
    element(svg, 'path', { class: 'gridlines', d: lines });
    const every = Math.ceil(Math.max(config.grid_width, config.grid_height) / 16);
    const label = (x, y, text) => {
      element(svg, 'text', { class: 'axis-label', x, y, 'data-size': 0.27 }).textContent = text;
    };
    for (let x = 0; x < config.grid_width; x += every)
      label((x + 0.5) * CELL, height + margin * 0.5, x);
    for (let y = 0; y < config.grid_height; y += every)
      label(-margin * 0.5, height - (y + 0.5) * CELL, y);
  }

  /** A square for each cell of the search maps; nothing without maps. */
  function drawSearched() {
    if (!episode.searchedAt) return [];
    return Array.from(episode.searchedAt[0], (_, cell) => {
      const [x, y] = centre([cell % config.grid_width, Math.floor(cell / config.grid_width)]);
      return element(svg, 'rect', {
        class: 'searched',
        x: x - CELL / 2,
        y: y - CELL / 2,
        width: CELL,
        height: CELL,
      });
    });
  }

  /** A square for each cell that any UAV reports in the end; nothing without reports. */
  function drawReported() {
    const last = episode.frames[episode.lastStep].reports ?? [];
    const cells = new Map(last.flatMap(([any]) => any).map((cell) => [`${cell}`, cell]));
    return [...cells].map(([key, cell]) => {
      const [x, y] = centre(cell);
      const square = { x: x - CELL / 2, y: y - CELL / 2, width: CELL, height: CELL };
      return { key, node: element(svg, 'rect', { class: 'reported', ...square }) };
    });
  }

  function cross(cell, size) {
    const [x, y] = centre(cell);
    const full = 2 * size;
    return `M${x - size} ${y - size}l${full} ${full}m0 ${-full}l${-full} ${full}`;
  }

  function drawCross(name, cell, size, title) {
    const node = element(svg, 'path', { class: name, d: cross(cell, size) });
    element(node, 'title').textContent = title;
    return node;
  }

  /** The highest level of a report of each cell, as one UAV knows it or as any UAV does. */
  function reportLevels(frame, selection) {
    const known = frame.reports ?? [];
    const levels = new Map();
    for (const uav of selection.uav === undefined ? known : [known[selection.uav] ?? []]) {
      uav.forEach((cells, below) => {
        for (const key of cells.map(String)) {
          levels.set(key, Math.max(levels.get(key) ?? 0, below + 1));
        }
      });
    }
    return levels;
  }

  function drawDepot(cell) {
    const [x, y] = centre(cell);
    const group = element(svg, 'g', { class: 'depot', transform: `translate(${x} ${y})` });
    element(group, 'title').textContent = `Depot at (${cell})`;
    element(group, 'rect', {
      x: -CELL / 2 + 3,
      y: -CELL / 2 + 3,
      width: CELL - 6,
      height: CELL - 6,
      rx: 6,
    });
    element(group, 'path', { d: 'M2 -13L-8 2H-1L-3 13L8 -3H1Z' });
  }

  function hotspotPlace(cell) {
    const [x, y] = centre(cell);
    return `translate(${x} ${y})`;
  }

  function tagPlace(cell) {
    const [x, y] = centre(cell);
    return `translate(${x - CELL / 2 + 3} ${y - CELL / 2 + 2})`;
  }

  function placeHotspots(cells) {
    placedHotspots = cells;
    cells.forEach((cell, id) => {
      hotspots[id].group.setAttribute('transform', hotspotPlace(cell));
      tags[id].setAttribute('transform', tagPlace(cell));
    });
  }

  function drawHotspot(cell, id) {
    const group = element(svg, 'g', {
      class: 'hotspot',
      'data-hotspot': id,
      transform: hotspotPlace(cell),
    });
    group.addEventListener('click', () => onSelect({ hotspot: id }));
    const title = element(group, 'title');
    const half = CELL / 2 - 2;
    element(group, 'rect', {
      class: 'box',
      x: -half,
      y: -half,
      width: 2 * half,
      height: 2 * half,
      rx: 7,
    });
    element(group, 'path', { class: 'known-back', d: `M${-half + 6} ${half}H${half - 6}` });
    const known = element(group, 'path', {
      class: 'known',
      d: `M${-half + 6} ${half}H${half - 6}`,
      pathLength: 1,
    });
    element(group, 'rect', {
      class: 'pick',
      x: -half - 4,
      y: -half - 4,
      width: 2 * half + 8,
      height: 2 * half + 8,
      rx: 10,
    });
    element(group, 'path', { class: 'tick', d: `M${half - 13} ${half - 7}l4 4l8 -9` });
    const ripples = ['confirmed', 'informed'].map((kind) => ({
      kind,
      node: element(group, 'circle', { class: `ripple ${kind}` }),
    }));
    return { group, title, known, ripples };
  }

  /** The number stands above the UAVs, so that it is readable while they gather on the hotspot. */
  function drawTag(cell, id) {
    const group = element(svg, 'g', { class: 'hotspot-tag', transform: tagPlace(cell) });
    element(group, 'circle');
    element(group, 'text', { 'data-size': 0.24 }).textContent = id;
    return group;
  }

  /** A circle around the cells in which the selected UAV may raise a false alarm. */
  function drawFootprint(cell) {
    const shown = cell !== undefined && episode.footprint !== undefined;
    footprint.setAttribute('r', shown ? (episode.footprint + 0.5) * CELL : 0);
    if (!shown) return;
    const [cx, cy] = centre(cell);
    footprint.setAttribute('cx', cx);
    footprint.setAttribute('cy', cy);
  }

  function drawUav(id) {
    const group = element(fleet, 'g', { class: 'uav', 'data-uav': id });
    group.addEventListener('click', () => onSelect({ uav: id }));
    const title = element(group, 'title');
    const halo = element(group, 'circle', { class: 'halo' });
    const learn = element(group, 'circle', { class: 'learn' });
    element(group, 'circle', { class: 'pick', r: 19 });
    const body = element(group, 'circle', { class: 'body', r: 11 });
    element(group, 'circle', { class: 'ring-back', r: 14 });
    const ring = element(group, 'path', {
      class: 'ring',
      d: 'M0 -14A14 14 0 0 1 0 14A14 14 0 0 1 0 -14',
      pathLength: 1,
    });
    const name = element(group, 'text', { class: 'name' });
    name.textContent = id;
    element(group, 'path', { class: 'state home', d: 'M-7 -20L0 -26L7 -20' });
    element(group, 'path', { class: 'state cross', d: 'M-6 -6L6 6M6 -6L-6 6' });
    return { group, title, halo, learn, body, ring, name };
  }

  /** The UAVs of each occupied cell, by "x,y". */
  function cells(t) {
    const byCell = new Map();
    episode.frames[t].positions.forEach(([x, y], id) => {
      const key = `${x},${y}`;
      if (!byCell.has(key)) byCell.set(key, []);
      byCell.get(key).push(id);
    });
    return byCell;
  }

  /** The place and size of each UAV in frame t: the UAVs of one cell are spread over it. */
  function layout(t) {
    if (layouts[t]) return layouts[t];
    const places = new Array(uavCount);
    for (const ids of cells(t).values()) {
      const [cx, cy] = centre(episode.frames[t].positions[ids[0]]);
      const fan = fanOut(ids.length);
      ids.forEach((id, k) => {
        places[id] = {
          x: cx + fan.at[k][0] * glyph,
          y: cy + fan.at[k][1] * glyph,
          scale: (fan.scale * glyph) / CELL,
        };
      });
    }
    return (layouts[t] = places);
  }

  function draw(time, selection, stepChanged) {
    const t = Math.floor(time);
    const frame = episode.frames[t];
    const places = placesAt(time, t);
    places.forEach((place, id) =>
      uavs[id].group.setAttribute(
        'transform',
        `translate(${place.x.toFixed(2)} ${place.y.toFixed(2)}) scale(${place.scale.toFixed(3)})`,
      ),
    );
    const point = (id) => `${places[id].x.toFixed(1)} ${places[id].y.toFixed(1)}`;
    const line = ([i, k]) => `M${point(i)}L${point(k)}`;
    const isMine = ([i, k]) => i === selection.uav || k === selection.uav;
    links.setAttribute('d', frame.links.map(line).join(''));
    ownLinks.setAttribute(
      'd',
      selection.uav === undefined ? '' : frame.links.filter(isMine).map(line).join(''),
    );
    tails.setAttribute(
      'd',
      places
        .map((place, id) => tail(t, id) + `L${place.x.toFixed(1)} ${place.y.toFixed(1)}`)
        .join(''),
    );
    drawRipples(time, t);
    counts.style.visibility = time === t ? 'visible' : 'hidden';
    if (stepChanged) drawStep(t, frame, selection);
  }

  /** Shows the number of UAVs in a cell that holds too many for their names to be readable. */
  function drawCounts(t) {
    counts.replaceChildren();
    for (const [key, ids] of cells(t)) {
      if (ids.length < 6) continue;
      const [x, y] = centre(key.split(',').map(Number));
      const text = element(counts, 'text', {
        x: x + glyph * 0.62,
        y: y + glyph * 0.5,
        'data-size': 0.3,
      });
      text.textContent = `${ids.length}×`;
      fitText(text);
    }
  }

  /** A text is as large as its part of the glyph, and at least READABLE_PX on the screen. */
  function fitText(text) {
    const size = Math.max(glyph * Number(text.dataset.size), READABLE_PX * unitsPerPx);
    text.setAttribute('font-size', size.toFixed(2));
    text.parentNode.querySelector('circle')?.setAttribute('r', (0.8 * size).toFixed(2));
  }

  function fit() {
    const shown = svg.getBoundingClientRect();
    if (!shown.width || !svg.isConnected) return;
    unitsPerPx = Math.max(view[2] / shown.width, view[3] / shown.height);
    svg.querySelectorAll('text[data-size]').forEach(fitText);
    if (lastStep) drawStep(...lastStep);
  }

  function placesAt(time, t) {
    const from = layout(t);
    if (time === t || t === episode.lastStep) return from;
    const to = layout(t + 1);
    const s = ease(time - t);
    const mix = (a, b) => a + (b - a) * s;
    return from.map((place, id) => ({
      x: mix(place.x, to[id].x),
      y: mix(place.y, to[id].y),
      scale: mix(place.scale, to[id].scale),
    }));
  }

  function tail(t, id) {
    let path = '';
    for (let past = Math.max(0, t - 3); past <= t; past += 1) {
      const { x, y } = layout(past)[id];
      path += `${path ? 'L' : 'M'}${x.toFixed(1)} ${y.toFixed(1)}`;
    }
    return path;
  }

  function drawRipples(time, t) {
    const spread = (node, age, lifetime, from, to) => {
      const shown = age >= 0 && age < lifetime;
      node.style.display = shown ? 'inline' : 'none';
      if (!shown) return;
      node.setAttribute('r', from + (to - from) * (age / lifetime));
      node.setAttribute('stroke-opacity', 1 - age / lifetime);
    };
    hotspots.forEach(({ ripples }, id) => {
      for (const { kind, node } of ripples) {
        const at = (kind === 'confirmed' ? episode.confirmedAt : episode.informedAt)[id];
        spread(node, at === undefined ? -1 : time - at, 2.5, glyph * 0.5, glyph * 1.9);
      }
    });
    const before = episode.frames[Math.max(0, t - 1)];
    uavs.forEach(({ learn }, id) => {
      const learned = episode.frames[t].knowledge[id].size > before.knowledge[id].size;
      spread(learn, learned ? time - t : -1, 0.9, 14, 32);
    });
  }

  function drawStep(t, frame, selection) {
    lastStep = [t, frame, selection];
    const maps =
      selection.uav === undefined ? episode.searchedAt : [episode.searchedAt?.[selection.uav]];
    searched.forEach((node, cell) => {
      node.style.visibility = maps.some((map) => map[cell] <= t) ? 'visible' : 'hidden';
    });
    for (const { node, t: since } of [...visited, ...falsely]) {
      node.style.visibility = since <= t ? 'visible' : 'hidden';
    }
    const levels = reportLevels(frame, selection);
    for (const { key, node } of reported) node.style.fillOpacity = 0.16 * (levels.get(key) ?? 0);
    const seen = frame.false_alarms ?? [];
    const raised = selection.uav === undefined ? seen.flat() : seen[selection.uav] ?? [];
    drawFootprint(frame.positions[selection.uav]);
    alarms.setAttribute('d', raised.map((cell) => cross(cell, 5)).join(''));
    if (frame.hotspots !== placedHotspots) placeHotspots(frame.hotspots);
    hotspots.forEach(({ group, title, known }, id) => {
      for (const node of [group, tags[id]]) {
        node.classList.toggle('confirmed', frame.confirmed.has(id));
        node.classList.toggle('informed', frame.informed.has(id));
      }
      group.classList.toggle('selected', selection.hotspot === id);
      known.setAttribute('stroke-dasharray', `${frame.knownBy[id] / uavCount} 2`);
      setText(
        title,
        `Hotspot ${id}: ${hotspotState(frame, id)}, ` +
          `known to ${frame.knownBy[id]} of ${uavCount} UAVs`,
      );
    });
    const lowest = config.rtb_threshold_kwh / config.battery_capacity_kwh;
    uavs.forEach(({ group, title, halo, body, ring, name }, id) => {
      const pilot = frame.pilot_density?.[id];
      const share = pilot === undefined ? 0 : pilotShare(config, pilot);
      body.style.fill = colour(share);
      halo.setAttribute('r', 15 + 16 * share);
      halo.setAttribute('fill-opacity', frame.grounded.has(id) ? 0 : 0.05 + 0.2 * share);
      ring.setAttribute('stroke-dasharray', `${frame.soc[id]} 2`);
      group.classList.toggle('low', frame.soc[id] < lowest);
      group.classList.toggle('grounded', frame.grounded.has(id));
      group.classList.toggle('returning', frame.returning.has(id) && !frame.grounded.has(id));
      group.classList.toggle('selected', selection.uav === id);
      const { scale } = layout(t)[id];
      const size = Math.max(READABLE_PX, (READABLE_PX * unitsPerPx) / scale);
      name.setAttribute('font-size', size.toFixed(1));
      group.classList.toggle('tiny', scale * CELL < glyph * 0.4 || size > WIDEST_NAME);
      setText(
        title,
        `UAV ${id}: ${percent(frame.soc[id])} charged, ${uavState(frame, id)}, ` +
          `knows ${frame.knowledge[id].size} of ${episode.hotspotCount} hotspots`,
      );
    });
    drawCounts(t);
    const steps =
      selection.uav === undefined
        ? []
        : episode.frames.slice(0, t + 1).map((past) => centre(past.positions[selection.uav]));
    route.setAttribute('d', steps.map(([x, y], k) => `${k ? 'L' : 'M'}${x} ${y}`).join(''));
    if (selection.uav !== undefined) fleet.append(uavs[selection.uav].group);
  }
}

/** Centres and size, in cells, of `count` discs packed as a honeycomb inside one cell. */
function fanOut(count) {
  if (count === 1) return { at: [[0, 0]], scale: 0.86 };
  const lattice = [];
  const reach = Math.ceil(Math.sqrt(count)) + 1;
  const [offsetX, offsetY] =
    count === 2 || count === 4 ? [0.5, 0] : count === 3 ? [0.5, 0.289] : [0, 0];
  for (let row = -reach; row <= reach; row += 1) {
    for (let column = -reach; column <= reach; column += 1) {
      const [x, y] = [column + (row & 1) / 2 - offsetX, row * 0.866 - offsetY];
      lattice.push([x, y, Math.hypot(x, y) + Math.atan2(y, x) * 1e-6]);
    }
  }
  const chosen = lattice.sort((a, b) => a[2] - b[2]).slice(0, count);
  const mean = (axis) => chosen.reduce((sum, point) => sum + point[axis], 0) / count;
  const [mx, my] = [mean(0), mean(1)];
  const radius = chosen.reduce((most, [x, y]) => Math.max(most, Math.hypot(x - mx, y - my)), 0);
  const pitch = Math.min(0.56, 0.7 / (radius + 0.5));
  return { at: chosen.map(([x, y]) => [(x - mx) * pitch, (y - my) * pitch]), scale: pitch * 1.24 };
}

const ease = (s) => { const u = Math.min(1, s / 0.8); return u * u * (3 - 2 * u); };
const percent = (fraction) => `${Math.round(100 * fraction)} %`;
const pilotShare = (config, pilot) =>
  (pilot - config.pilot_density_min) / (config.pilot_density_max - config.pilot_density_min || 1);
const pilotColours = () => (share) =>
  `color-mix(in oklab, var(--sense) ${(100 * share).toFixed(1)}%, var(--talk))`;

function hotspotState(frame, id) {
  if (frame.informed.has(id)) return 'informed';
  return frame.confirmed.has(id) ? 'confirmed' : 'unconfirmed';
}

function uavState(frame, id) {
  if (frame.grounded.has(id)) return 'grounded';
  return frame.returning.has(id) ? 'returning' : 'flying';
}
