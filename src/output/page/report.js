'use strict';
(() => {
  const $ = (id) => document.getElementById(id);
  const data = JSON.parse($('data').textContent);
  const palette = ['#0072b2', '#e69f00', '#009e73', '#cc79a7', '#d55e00', '#56b4e9', '#7a7f87', '#b3a000'];

  function element(tag, attributes = {}, ...children) {
    const node = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) {
      if (name.startsWith('on')) node.addEventListener(name.slice(2), value);
      else if (value !== null && value !== undefined) node.setAttribute(name, value);
    }
    node.append(...children.filter((child) => child !== null && child !== undefined));
    return node;
  }
  const isNumber = (x) => typeof x === 'number' && Number.isFinite(x);
  function number(x, digits = 4) {
    if (!isNumber(x)) return '\u2013';
    const size = Math.abs(x);
    if (x !== 0 && (size < 1e-3 || size >= 1e6)) return String(Number(x.toPrecision(Math.min(digits, 3))).toExponential());
    return String(Number(x.toPrecision(size >= 1000 ? Math.max(digits, Math.floor(Math.log10(size)) + 1) : digits)));
  }
  const kindOf = (status) => status === 'ok' ? 'ok' : status === 'pending' ? 'pending'
    : ['doubtful', 'ambiguous', 'not_converged'].includes(status) ? 'doubt' : 'bad';
  const statusMark = (status) => element('span', {class: `status ${kindOf(status)}`}, status.replace(/_/g, ' '));
  const rank = {bad: 0, doubt: 1, pending: 2, ok: 3};

  // ---- table ----
  const columns = [
    {title: 'Status', cell: (c) => statusMark(c.status), value: (c) => rank[kindOf(c.status)] + c.status},
    {title: 'Case', cell: (c) => c.name, value: (c) => c.name},
    {title: '', cell: (c) => c.picture ? element('img', {class: 'thumb', src: c.picture, alt: `slices of ${c.name}`, loading: 'lazy'}) : ''},
    {title: 'Volume, ml', number: true, cell: (c) => number(c.volume_ml), value: (c) => c.volume_ml},
    {title: 'Objects', number: true, wide: true, cell: (c) => number(c.objects.length || null), value: (c) => c.objects.length},
    {title: 'Evidence', number: true, wide: true, cell: (c) => number(c.evidence, 3), value: (c) => c.evidence},
    {title: 'Time, s', number: true, wide: true, cell: (c) => number(c.seconds, 3), value: (c) => c.seconds},
    {title: 'Why', message: true, wide: true, cell: (c) => element('span', {}, c.reason), value: (c) => c.reason},
  ];
  const state = {sort: 0, down: false, filter: '', chosen: -1, order: []};
  const rows = new Map();

  function compare(a, b) {
    const value = columns[state.sort].value;
    const x = value(a), y = value(b);
    const missing = (v) => v === null || v === undefined || v === '';
    if (missing(x) || missing(y)) return missing(x) - missing(y);
    const order = isNumber(x) ? x - y : String(x).localeCompare(String(y), undefined, {numeric: true});
    return state.down ? -order : order;
  }
  function classesOf(column) {
    const names = [column.number && 'number', column.wide && 'wide', column.message && 'message'].filter(Boolean);
    return names.length ? names.join(' ') : null;
  }
  function fillHead() {
    const cells = columns.map((column, i) => {
      const th = element('th', {scope: 'col', class: classesOf(column)});
      if (column.value) {
        th.setAttribute('aria-sort', state.sort === i ? (state.down ? 'descending' : 'ascending') : 'none');
        th.append(element('button', {type: 'button', onclick: () => sortBy(i)}, column.title));
      }
      return th;
    });
    $('table').tHead.replaceChildren(element('tr', {}, ...cells));
  }
  function sortBy(i) {
    state.down = state.sort === i ? !state.down : false;
    state.sort = i;
    fillHead();
    fillBody();
    $('table').tHead.querySelectorAll('th')[i].querySelector('button').focus();
  }
  function rowOf(c) {
    if (!rows.has(c.index)) {
      const cells = columns.map((column) => element('td', {class: classesOf(column), title: column.message ? c.reason : null}, column.cell(c)));
      rows.set(c.index, element('tr', {tabindex: '0', 'data-index': c.index, 'aria-selected': 'false',
        onclick: () => choose(c.index), onkeydown: (e) => { if (e.key === 'Enter') choose(c.index, true); }}, ...cells));
    }
    return rows.get(c.index);
  }
  function fillBody() {
    const wanted = state.filter.toLowerCase();
    state.order = data.cases.filter((c) => `${c.name} ${c.status} ${c.status.replace(/_/g, ' ')}`.toLowerCase().includes(wanted));
    state.order.sort((a, b) => compare(a, b) || a.index - b.index);
    $('table').tBodies[0].replaceChildren(...state.order.map(rowOf));
    $('shown').textContent = state.order.length === data.cases.length ? '' : `${state.order.length} of ${data.cases.length}`;
  }
  function fillCounts() {
    const counts = new Map();
    for (const c of data.cases) counts.set(c.status, (counts.get(c.status) || 0) + 1);
    const sorted = [...counts].sort((a, b) => rank[kindOf(a[0])] - rank[kindOf(b[0])] || b[1] - a[1]);
    $('counts').replaceChildren(...sorted.map(([status, count]) => element('span', {}, `${count} `, statusMark(status))));
  }

  // ---- plots ----
  const SVG = 'http://www.w3.org/2000/svg';
  function shape(tag, attributes, text) {
    const node = document.createElementNS(SVG, tag);
    for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
    if (text !== undefined) node.textContent = text;
    return node;
  }
  // curves: [{name, points: [[step, value]...]}], stages: [{name, from, to}] in steps; logarithmic where all is positive.
  function plot(holder, curves, stages) {
    const values = curves.flatMap((curve) => curve.points.map((p) => p[1])).filter((v) => isNumber(v) && v > 0);
    if (values.length === 0) { holder.replaceChildren(element('p', {}, element('small', {}, 'No steps were kept in this report.'))); return; }
    const width = 580, height = 250, left = 52, right = 8, top = 20, bottom = 26;
    const low = Math.log10(Math.max(Math.min(...values), Math.max(...values) * 1e-8)), high = Math.log10(Math.max(...values));
    const pad = Math.max(0.05, 0.06 * (high - low)), y0 = low - pad, y1 = high + pad;
    const steps = Math.max(1, ...stages.map((s) => s.to));
    const x = (step) => left + (width - left - right) * step / steps;
    const y = (value) => top + (height - top - bottom) * (y1 - Math.log10(value)) / (y1 - y0);
    const svg = shape('svg', {viewBox: `0 0 ${width} ${height}`, role: 'img'});
    const every = Math.max(1, Math.ceil((y1 - y0) / 6));
    let ticks = [];
    for (let power = Math.ceil(y0); power <= y1; ++power) if (power % every === 0) ticks.push(10 ** power);
    if (ticks.length < 2) ticks = [10 ** (y0 + 0.1 * (y1 - y0)), 10 ** ((y0 + y1) / 2), 10 ** (y1 - 0.1 * (y1 - y0))];
    for (const tick of ticks) {
      svg.append(shape('line', {class: 'grid', x1: left, x2: width - right, y1: y(tick), y2: y(tick)}));
      svg.append(shape('text', {x: left - 6, y: y(tick) + 4, 'text-anchor': 'end'}, number(tick, 2)));
    }
    stages.forEach((stage, i) => {
      if (i > 0) svg.append(shape('line', {class: 'stage', x1: x(stage.from), x2: x(stage.from), y1: top, y2: height - bottom}));
      if (x(stage.to) - x(stage.from) > 7 * stage.name.length || i === stages.length - 1) {
        const last = i === stages.length - 1;
        svg.append(shape('text', {x: last ? width - right : x(stage.from) + 3, y: top - 7, 'text-anchor': last ? 'end' : 'start'}, stage.name));
      }
    });
    const spacing = Math.max(1, Math.ceil(steps / 10));
    for (let step = 0; step <= steps; step += spacing) svg.append(shape('text', {x: x(step), y: height - 9, 'text-anchor': 'middle'}, String(step)));
    curves.forEach((curve, i) => {
      const color = palette[i % palette.length];
      let path = '', open = false;
      for (const [step, value] of curve.points) {
        if (!(isNumber(value) && value > 0 && Math.log10(value) >= y0)) { open = false; continue; }
        path += `${open ? 'L' : 'M'}${x(step).toFixed(1)} ${y(value).toFixed(1)}`;
        open = true;
        const dot = shape('circle', {cx: x(step), cy: y(value), r: 2.4, fill: color});
        dot.append(shape('title', {}, `${curve.name}, step ${step}: ${number(value)}`));
        svg.append(dot);
      }
      svg.append(shape('path', {d: path, fill: 'none', stroke: color, 'stroke-width': 1.8}));
    });
    const legend = element('div', {class: 'legend'});
    if (curves.length > 1) curves.forEach((curve, i) => legend.append(element('span', {}, element('span', {class: 'swatch', style: `background:${palette[i % palette.length]}`}), curve.name)));
    holder.replaceChildren(svg, legend);
  }
  function drawPlots(object) {
    const curves = new Map(), moves = [], stages = [];
    let step = 0;
    for (const stage of object ? object.stages : []) {
      const from = step;
      for (const one of stage.history || []) {
        ++step;
        moves.push([step, one.move_mm]);
        for (const [name, value] of Object.entries(one.energies)) {
          if (!curves.has(name)) curves.set(name, []);
          curves.get(name).push([step, value]);
        }
      }
      if (step > from) stages.push({name: stage.name, from, to: step});
      // A stage weighs anew: the curve does not go on across its start.
      for (const points of curves.values()) points.push([step, null]);
    }
    plot($('energies'), [...curves].map(([name, points]) => ({name, points})), stages);
    plot($('moves'), [{name: 'move, mm', points: moves}], stages);
  }

  // ---- the chosen case ----
  function table(rowsOfCells, className) {
    return element('table', {class: className}, element('tbody', {}, ...rowsOfCells.map(([head, ...cells]) =>
      element('tr', {}, element('th', {scope: 'row'}, head), ...cells.map((cell) => element('td', {}, cell))))));
  }
  function factsOf(c, object, i) {
    const color = `rgb(${object.color.join(',')})`;
    const facts = [
      ['Status', statusMark(object.status)],
      ['Volume', `${number(object.volume_ml)} ml`],
      ['Volume of the mask', `${number(object.mask_ml)} ml`],
      ['Area', `${number(object.area_mm2)} mm\u00b2`],
      ['Model', `${object.model}, ${object.control_points} control points`],
      ['Evidence', number(object.evidence, 3)],
      ['Object against background', `${object.polarity}, ${object.boundary}`],
      ['Levels inside, outside', `${number(object.level_inside)}, ${number(object.level_outside)}`],
      ['Steps', `${object.iterations}, ${object.convergence}`],
      ['Watertight, handles', `${object.watertight ? 'yes' : 'no'}, ${object.genus}`],
      ['Cuts itself', object.self_intersections === 0 ? 'no' : `${object.self_intersections} pairs of facets`],
      ['Touches the border', object.touches_border ? 'yes' : 'no'],
    ];
    const title = c.objects.length > 1 ? `${object.label} ${object.name}` : 'Surface';
    const body = [element('h3', {}, element('span', {class: 'swatch', style: `background:${color}`}), title), table(facts, 'facts')];
    return c.objects.length > 1 && i > 0 ? [element('details', {}, element('summary', {}, element('span', {class: 'swatch', style: `background:${color}`}), `${title}: ${object.status}, ${number(object.volume_ml)} ml`), body[1])] : body;
  }
  function valueText(value) { return typeof value === 'string' ? value : JSON.stringify(value); }
  const known = (x) => isNumber(x) && x < 0 ? null : x;  // -1: not measured
  function moreOf(c) {
    const parts = [];
    const object = c.objects[0];
    if (object && object.stages.length) {
      const head = element('tr', {}, ...['Stage', 'Control points', 'Samples', 'Steps', 'Ended', 'Last move, mm', 'Edge distance, rms mm', 'Time, s'].map((t) => element('th', {}, t)));
      const lines = object.stages.map((s) => element('tr', {}, ...[s.name, s.control_points, s.samples, s.steps, s.reason, number(known(s.last_move_mm), 3), number(known(s.rms_residual_mm), 3), number(s.seconds, 3)].map((t) => element('td', {}, String(t)))));
      parts.push(element('details', {open: ''}, element('summary', {}, 'Stages of the fit'), element('table', {}, element('tbody', {}, head, ...lines))));
    }
    if (object && object.hypotheses.length > 1) {
      const head = element('tr', {}, ...['Reading', 'Status', 'Evidence', 'Volume, ml', ''].map((t) => element('th', {}, t)));
      const lines = object.hypotheses.map((h) => element('tr', {}, ...[h.name, h.status, number(h.evidence, 3), number(h.volume_ml), h.chosen ? 'chosen' : ''].map((t) => element('td', {}, t))));
      parts.push(element('details', {}, element('summary', {}, 'Readings of the image that were tried'), element('table', {}, element('tbody', {}, head, ...lines))));
    }
    if (c.settings) parts.push(element('details', {}, element('summary', {}, 'Settings'), table(Object.entries(c.settings).filter(([, v]) => v !== null).map(([k, v]) => [k, k === 'stage' ? element('pre', {}, JSON.stringify(v, null, 1)) : valueText(v)]))));
    if (c.provenance) {
      const p = c.provenance;
      const lines = [['Finished', p.finished], ['Program', `${p.program} (${Object.entries(p.libraries).map(([n, v]) => `${n} ${v}`).join(', ')})`],
        ['Command', element('code', {}, p.command)], ['Report', element('code', {}, p.report)],
        ...p.inputs.map((f) => [`Input: ${f.role}`, element('code', {}, `${f.path}\nsha256 ${f.sha256}`)]),
        ...p.outputs.map((f) => [`Output: ${f.kind}`, element('code', {}, `${f.path}\nsha256 ${f.sha256}`)]),
        ['Grid', p.grid], ['Time', p.seconds], ['Largest memory', p.memory]];
      parts.push(element('details', {}, element('summary', {}, 'Provenance'), table(lines)));
    }
    if (c.warnings && c.warnings.length) parts.unshift(element('details', {open: ''}, element('summary', {}, 'Warnings'), ...c.warnings.map((w) => element('p', {}, w))));
    return parts;
  }
  function choose(index, focus) {
    state.chosen = index;
    const c = data.cases[index];
    for (const [i, row] of rows) row.setAttribute('aria-selected', String(i === index));
    rowOf(c).scrollIntoView({block: 'nearest'});
    $('name').replaceChildren(c.name, statusMark(c.status));
    $('reason').textContent = c.reason;
    $('facts').replaceChildren(...c.objects.flatMap((object, i) => factsOf(c, object, i)));
    $('more').replaceChildren(...moreOf(c));
    $('picture').src = c.picture || 'data:,';
    $('picture').alt = `slices of ${c.name} with the surface`;
    $('picture').style.visibility = c.picture ? 'visible' : 'hidden';
    document.querySelector('.plots').hidden = c.objects.length === 0;
    drawPlots(c.objects[0]);
    history.replaceState(null, '', `#${encodeURIComponent(c.name)}`);
    show(c);
    if (focus) $('name').focus();
  }

  // ---- viewer ----
  const views = [['Slices and surface', 'multi'], ['Axial', 'axial'], ['Coronal', 'coronal'], ['Sagittal', 'sagittal'], ['Surface', 'render']];
  const viewer = {promise: null, nv: null, mesh: null, view: 'multi', surface: true, request: 0};

  function bytesOf(id) {
    const text = atob($(id).textContent.trim());
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
    return bytes;
  }
  async function unpacked(id) {
    return new Response(new Blob([bytesOf(id)]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();
  }
  function base64Of(id) { return $(id).textContent.trim(); }
  async function makeViewer() {
    if (!$('niivue').textContent.trim()) throw new Error('This page was made without the viewer.');
    if (typeof DecompressionStream === 'undefined') throw new Error('This browser is too old for the viewer.');
    if (!document.createElement('canvas').getContext('webgl2')) throw new Error('This browser has no WebGL 2, so there is no viewer.');
    const script = element('script');
    script.textContent = new TextDecoder().decode(await unpacked('niivue'));
    document.head.append(script);
    const nv = new window.niivue.Niivue({backColor: [0.047, 0.051, 0.063, 1], show3Dcrosshair: false, isOrientCube: false, dragAndDropEnabled: false,
      logLevel: 'error', isRadiologicalConvention: true, isSliceMM: true, crosshairWidth: 0.25, crosshairWidthUnit: 'percent', crosshairColor: [0.34, 0.71, 0.91, 0.6], fontColor: [0.85, 0.87, 0.9, 1], fontSizeScaling: 0.35, meshThicknessOn2D: 0,
      loadingText: '', multiplanarPadPixels: 4, isCornerOrientationText: true});
    await nv.attachToCanvas($('canvas'));
    nv.setInterpolation(false);
    // In space the surface alone is shown; in the slices its exact cut is drawn over them, after each drawing of the scene.
    nv.drawImage3D = () => {};
    const draw = nv.drawSceneCore.bind(nv);
    nv.drawSceneCore = () => { const text = draw(); drawCuts(nv); return text; };
    return nv;
  }
  // MZ3: header, corners of the triangles, positions in RAS mm, colours.
  function parsedMesh(buffer) {
    const view = new DataView(buffer), triangles = view.getUint32(4, true), vertices = view.getUint32(8, true);
    let at = 16 + view.getUint32(12, true);
    const corners = new Uint32Array(buffer.slice(at, at += 12 * triangles)), points = new Float32Array(buffer.slice(at, at += 12 * vertices));
    return {corners, points, colors: new Uint8Array(buffer.slice(at, at + 4 * vertices))};
  }
  function drawCuts(nv) {
    const screen = $('canvas'), sheet = $('cuts'), pen = sheet.getContext('2d');
    if (sheet.width !== screen.width || sheet.height !== screen.height) { sheet.width = screen.width; sheet.height = screen.height; }
    pen.clearRect(0, 0, sheet.width, sheet.height);
    if (!viewer.mesh || !viewer.surface) return;
    pen.lineWidth = 1.7 * (window.devicePixelRatio || 1);
    pen.lineCap = 'round';
    // World axes that run to the right, up and through the picture.
    const axes = [[0, 1, 2], [0, 2, 1], [1, 2, 0]];
    for (const slice of nv.screenSlices) if (slice.axCorSag <= 2 && slice.AxyzMxy.length >= 5) drawCut(pen, viewer.mesh, slice, axes[slice.axCorSag]);
  }
  function drawCut(pen, {corners, points, colors}, slice, [right, up, through]) {
    const [left, top, width, height] = slice.leftTopWidthHeight, plane = slice.AxyzMxy;
    const x = (p) => left + width * (p[0] - slice.leftTopMM[0]) / slice.fovMM[0];
    const y = (p) => top + height * (1 - (p[1] - slice.leftTopMM[1]) / slice.fovMM[1]);
    const place = (v) => {
      const a = points[3 * v + right], b = points[3 * v + up];
      return [a, b, points[3 * v + through] - plane[2] - plane[4] * (b - plane[1]) + plane[3] * (a - plane[0])];
    };
    pen.save();
    pen.beginPath();
    pen.rect(Math.min(left, left + width), top, Math.abs(width), height);
    pen.clip();
    let color = -1;
    for (let t = 0; t < corners.length; t += 3) {
      const p = [place(corners[t]), place(corners[t + 1]), place(corners[t + 2])], ends = [];
      for (let e = 0; e < 3; ++e) {
        const a = p[e], b = p[(e + 1) % 3];
        if ((a[2] >= 0) === (b[2] >= 0)) continue;
        const share = a[2] / (a[2] - b[2]);
        ends.push([a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]);
      }
      if (ends.length !== 2) continue;
      const c = 4 * corners[t], own = (colors[c] << 16) | (colors[c + 1] << 8) | colors[c + 2];
      if (own !== color) {
        if (color >= 0) pen.stroke();
        color = own;
        pen.strokeStyle = `rgb(${colors[c]},${colors[c + 1]},${colors[c + 2]})`;
        pen.beginPath();
      }
      pen.moveTo(x(ends[0]), y(ends[0]));
      pen.lineTo(x(ends[1]), y(ends[1]));
    }
    if (color >= 0) pen.stroke();
    pen.restore();
  }
  function setView(name) {
    viewer.view = name;
    for (const button of $('views').querySelectorAll('[data-view]')) button.setAttribute('aria-pressed', String(button.dataset.view === name));
    const nv = viewer.nv;
    if (!nv) return;
    const type = {axial: nv.sliceTypeAxial, coronal: nv.sliceTypeCoronal, sagittal: nv.sliceTypeSagittal, render: nv.sliceTypeRender, multi: nv.sliceTypeMultiplanar}[name];
    nv.opts.multiplanarShowRender = 1;
    nv.setMultiplanarLayout(2);
    nv.setSliceType(type);
    if (nv.volumes.length) nv.setOpacity(0, 1);
    nv.drawScene();
  }
  function setSurface(on) {
    viewer.surface = on;
    $('surface').setAttribute('aria-pressed', String(on));
    if (!viewer.nv || !viewer.nv.meshes.length) return;
    viewer.nv.setMeshProperty(viewer.nv.meshes[0].id, 'visible', on);
    viewer.nv.drawScene();
  }
  async function show(c) {
    const request = ++viewer.request;
    document.body.dataset.viewer = 'loading';
    const files = c.files || {};
    $('stage').classList.toggle('fixed', !files.volume && !files.mesh);
    if (!files.volume && !files.mesh) { document.body.dataset.viewer = 'none'; return; }
    try {
      viewer.promise = viewer.promise || makeViewer();
      const nv = viewer.nv = await viewer.promise;
      const {NVImage, NVMesh} = window.niivue;
      const volume = files.volume ? await NVImage.loadFromBase64({base64: base64Of(files.volume), name: 'volume.nii.gz', cal_min: 0, cal_max: 255}) : null;
      const packed = files.mesh ? await unpacked(files.mesh) : null;
      const mesh = packed ? await NVMesh.readMesh(packed, 'surface.mz3', nv.gl, 1, new Uint8Array([230, 159, 0, 255])) : null;
      if (request !== viewer.request) return;
      while (nv.meshes.length) nv.removeMesh(nv.meshes[0]);
      while (nv.volumes.length) nv.removeVolume(nv.volumes[0]);
      if (volume) nv.addVolume(volume);
      if (mesh) nv.addMesh(mesh);
      viewer.mesh = packed ? parsedMesh(packed) : null;
      nv.setRenderAzimuthElevation(130, 18);
      // The cross starts at the middle of the first object.
      if (volume && c.center) nv.scene.crosshairPos = nv.mm2frac(c.center);
      setView(volume ? viewer.view : 'render');
      setSurface(viewer.surface);
      $('note').textContent = volume ? files.note : 'The volume was not found when the page was made.';
      nv.resizeListener();
      nv.drawScene();
      document.body.dataset.viewer = 'ready';
    } catch (fault) {
      if (request !== viewer.request) return;
      $('stage').classList.add('fixed');
      document.body.dataset.viewer = 'failed';
      $('reason').textContent = `${c.reason} ${fault.message}`;
    }
  }

  // ---- start ----
  data.cases.forEach((c, index) => { c.index = index; });
  views.forEach(([title, name]) => $('views').append(element('button', {type: 'button', 'data-view': name, 'aria-pressed': String(name === viewer.view), onclick: () => setView(name)}, title)));
  $('views').append(element('button', {type: 'button', id: 'surface', 'aria-pressed': 'true', onclick: () => setSurface(!viewer.surface)}, 'Show surface'));
  $('filter').addEventListener('input', (e) => { state.filter = e.target.value; fillBody(); });
  document.addEventListener('keydown', (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey || e.target === $('filter') && e.key !== 'Escape') return;
    const at = state.order.findIndex((c) => c.index === state.chosen);
    const onTable = e.target.closest && e.target.closest('#table tbody');
    if ((e.key === 'j' || (onTable && e.key === 'ArrowDown')) && at + 1 < state.order.length) choose(state.order[at + 1].index);
    else if ((e.key === 'k' || (onTable && e.key === 'ArrowUp')) && at > 0) choose(state.order[at - 1].index);
    else if (e.key >= '1' && e.key <= '5') setView(views[Number(e.key) - 1][1]);
    else if (e.key === 's') setSurface(!viewer.surface);
    else if (e.key === '/') $('filter').focus();
    else if (e.key === 'Escape') $('filter').blur();
    else return;
    e.preventDefault();
    e.stopPropagation();
    if (onTable && rows.has(state.chosen)) rows.get(state.chosen).focus();
  }, true);
  fillCounts();
  fillHead();
  fillBody();
  if (data.cases.length === 1) $('cases').hidden = true;
  const wanted = decodeURIComponent(location.hash.slice(1));
  const first = state.order.find((c) => c.name === wanted) || state.order[0];
  if (first) choose(first.index);
})();
