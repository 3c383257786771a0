
'use strict';
// The page of wavepath serve. Protocol: docs/serve.md.

const id = (name) => document.getElementById(name);
const canvas = id('picture'), context = canvas.getContext('2d');
const MOVE_PAUSE = 25; // milliseconds between moves, of which the server takes 60 a second
let token = decodeURIComponent(location.hash.slice(1));
let socket = null, steers = false, retries = 0, count = 0, scene = null, status = null;
let answered = 0; // count of the newest move that a picture has shown
const moves = new Map(); // when those that no picture shows yet were sent

// What is said aloud as well: rarely, and never while pictures come.
function say(text) { id('said').textContent = text; }
function bar(text, buttons = []) {
  id('bar').hidden = !text;
  id('bar-text').textContent = text;
  for (const name of ['take', 'give', 'keep']) id(name).hidden = !buttons.includes(name);
}
function send(message) {
  if (!socket || socket.readyState !== WebSocket.OPEN) return;
  message.count = ++count;
  socket.send(JSON.stringify(message));
  if (['steer', 'view', 'camera', 'focus'].includes(message.type)) moves.set(count, performance.now());
}

// Connection

function connect() {
  if (!token) { id('ask').showModal(); return; }
  const scheme = location.protocol === 'https:' ? 'wss:' : 'ws:';
  socket = new WebSocket(`${scheme}//${location.host}/session`, 'wavepath.1');
  socket.binaryType = 'arraybuffer';
  socket.onopen = () => socket.send(JSON.stringify({type: 'hello', token}));
  socket.onmessage = (event) => typeof event.data === 'string' ? heard(JSON.parse(event.data)) : showFrame(event.data);
  socket.onclose = (event) => {
    steer(false);
    moves.clear();
    id('state').textContent = 'not connected';
    if (event.reason === 'wrong token') {
      token = '';
      id('ask').showModal();
      return;
    }
    retries += 1;
    const pause = Math.min(10, 2 ** (retries - 1));
    bar(`The server does not answer${event.reason ? ` (${event.reason})` : ''}; another try in ${pause} s.`);
    setTimeout(connect, 1000 * pause);
  };
}
id('ask').addEventListener('close', () => {
  token = id('token').value.trim().split('#').pop();
  if (token) history.replaceState(null, '', '#' + token);
  connect();
});

function heard(message) {
  if (message.type === 'scene') takeScene(message);
  else if (message.type === 'status') takeStatus(message);
  else if (message.type === 'role') takeRole(message);
  else if (message.type === 'picked') takePick(message);
  else if (message.type === 'copied') takeLine(message.line);
  else if (message.type === 'note') bar(message.text, steers ? [] : ['take']);
}

function steer(may) {
  steers = may;
  document.body.classList.toggle('watching', !may);
  for (const set of document.querySelectorAll('.steering')) set.disabled = !may;
}
function takeRole(role) {
  retries = 0;
  steer(role.steers);
  if (role.steers && role.asked) bar('Another viewer asks for control.', ['give', 'keep']);
  else if (role.steers) bar('');
  else bar('Another viewer steers; you are watching.', ['take']);
}
id('take').onclick = () => send({type: 'take'});
id('give').onclick = () => send({type: 'give'});
id('keep').onclick = () => bar('');

// Pictures: decoded one after the other, and acknowledged when they are shown.

let shownLast = Promise.resolve();
function showFrame(data) {
  shownLast = shownLast.then(() => draw(data)).catch(() => {});
}
async function draw(data) {
  const header = new DataView(data, 0, 32);
  const word = (index) => header.getUint32(4 * index, true);
  const frame = word(0), answers = word(1), format = header.getUint16(14, true);
  const width = header.getUint16(20, true), height = header.getUint16(22, true);
  const file = new Blob([new Uint8Array(data, 32)], {type: format === 2 ? 'image/png' : 'image/jpeg'});
  try {
    const image = await createImageBitmap(file);
    if (canvas.width !== width || canvas.height !== height) canvas.width = width, canvas.height = height;
    context.drawImage(image, 0, 0, width, height);
    image.close();
  } finally {
    if (socket && socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify({type: 'ack', frame}));
  }
  canvas.dataset.frame = frame;
  canvas.dataset.done = word(4);
  canvas.dataset.spp = word(2);
  canvas.dataset.coarse = header.getUint16(12, true);
  // The newest move that it shows, and those before it, which it overtook.
  if (answers > answered && moves.has(answers)) {
    const took = Math.round(performance.now() - moves.get(answers));
    id('latency').textContent = `${took} ms`;
    canvas.dataset.latency = took;
  }
  answered = Math.max(answered, answers);
  for (const sent of moves.keys()) if (sent <= answers) moves.delete(sent);
}

// What is told about it

function duration(seconds) {
  if (seconds === null || seconds === undefined) return 'unknown';
  if (seconds < 60) return `${seconds.toFixed(0)} s`;
  if (seconds < 3600) return `${(seconds / 60).toFixed(0)} min`;
  return `${(seconds / 3600).toFixed(1)} h`;
}
const percent = (value) => `${(100 * value).toPrecision(3)} %`;

function takeStatus(now) {
  if (status && now.state !== status.state && !['moving', 'rendering'].includes(now.state)) say(`Render: ${now.state}`);
  status = now;
  id('state').textContent = `${now.state}, ${now.coarse > 1 ? `1/${now.coarse} resolution` : `${now.spp} spp`}`;
  id('progress').value = now.fraction;
  id('spp').textContent = `${now.spp} of ${now.planned}`;
  const knows = now.error !== null;
  id('error').textContent = knows ? `${percent(now.error)} relative RMS, at ${now.error_spp} spp` : 'not yet known';
  id('interval').textContent = knows ? `${percent(now.ci95[0])} to ${percent(now.ci95[1])}` : '-';
  id('to-target').textContent = !now.target ? 'no target is set'
      : knows && now.error <= now.target ? 'reached' : duration(now.seconds_to_target);
  id('to-end').textContent = now.done ? 'done' : duration(now.seconds_left);
  id('rendered').textContent = `${now.seconds.toFixed(1)} s on the device`;
  id('rate').textContent = `${now.mrays_per_second.toFixed(2)} Mrays/s`;
  id('exposure-text').textContent = `${now.exposure >= 0 ? '+' : ''}${now.exposure.toFixed(2)} stops`;
  if (document.activeElement !== id('exposure')) id('exposure').value = now.exposure;
  document.title = `${scene ? scene.scene : 'wavepath'} - ${now.coarse > 1 ? 0 : now.spp} spp${now.done ? ', done' : ''}`;
  id('facts-memory') && (id('facts-memory').textContent = memoryText());
}
function memoryText() {
  const total = status ? Object.values(status.memory).reduce((sum, part) => sum + part, 0) : 0;
  return `${Math.round(total / 1048576)} MiB on the device`;
}

function fill(list, rows) {
  list.replaceChildren();
  for (const [term, text, name] of rows) {
    const dt = document.createElement('dt'), dd = document.createElement('dd');
    dt.textContent = term;
    dd.textContent = text;
    if (name) dd.id = name;
    list.append(dt, dd);
  }
}
function options(select, names, value) {
  if (select.dataset.names !== names.join()) {
    select.replaceChildren(...names.map((name) => new Option(name, name)));
    select.dataset.names = names.join();
  }
  select.value = value;
}
// Not what is being typed.
function put(input, value) { if (document.activeElement !== input) input.value = value; }

function takeScene(now) {
  scene = now;
  id('title').textContent = now.scene;
  canvas.setAttribute('aria-label', `Picture of ${now.scene}`);
  options(id('shown'), now.shown, now.show);
  options(id('tonemap'), now.tonemaps, now.tonemap);
  id('auto-exposure').checked = now.auto_exposure;
  put(id('exposure'), now.exposure);
  put(id('width'), now.width);
  put(id('height'), now.height);
  put(id('target'), now.target ? +(100 * now.target).toPrecision(6) : '');
  put(id('environment'), now.environment.source);
  put(id('intensity'), now.environment.intensity);
  put(id('rotation'), now.environment.degrees);
  id('environments').replaceChildren(...now.environments.filter(Boolean).map((name) => new Option(name, name)));
  buildSettings(now.settings);
  buildGains(now.groups);
  id('cameras').replaceChildren(...now.cameras.map((name, index) => {
    const button = document.createElement('button');
    button.type = 'button';
    button.textContent = name || `camera ${index}`;
    button.onclick = () => send({type: 'camera', to: String(index)});
    return button;
  }));
  fill(id('facts'), [['device', now.device], ['triangles', now.triangles.toLocaleString('en')],
      ['lights', String(now.lights)], ['lit by', now.light || 'as the command line says'],
      ['memory', memoryText(), 'facts-memory']]);
  fill(id('plan'), now.plan.map((step) => [step.what, `${step.taken} (${step.why})`]));
  id('notes').replaceChildren(...now.notes.map((text) => {
    const item = document.createElement('li');
    item.textContent = text;
    return item;
  }));
  id('notes-title').hidden = now.notes.length === 0;
}

function buildSettings(rows) {
  const box = id('settings'), names = rows.map((row) => row.name + row.kind).join();
  if (box.dataset.names !== names) {
    box.dataset.names = names;
    box.replaceChildren(...rows.map((row) => {
      const label = document.createElement('label');
      const input = document.createElement(row.kind === 'choice' ? 'select' : 'input');
      label.append(row.label, ' ', input);
      label.title = row.meaning;
      input.id = `set-${row.name}`;
      input.setAttribute('aria-description', row.meaning);
      if (row.kind === 'choice') options(input, row.choices, row.value);
      else if (row.kind === 'switch') input.type = 'checkbox';
      else input.type = 'number', input.min = row.lowest, input.max = row.highest, input.step = row.kind === 'whole' ? 1 : 'any';
      input.onchange = () => {
        const value = row.kind === 'switch' ? (input.checked ? row.on : row.off) : input.value;
        if (value !== '') send({type: 'set', name: row.name, value});
      };
      return label;
    }));
  }
  for (const row of rows) {
    const input = id(`set-${row.name}`);
    if (row.kind === 'switch') input.checked = row.value === row.on;
    else put(input, row.value);
  }
}
function buildGains(groups) {
  const box = id('gains'), names = groups.map((group) => group.name).join('\n');
  if (box.dataset.names !== names) {
    box.dataset.names = names;
    box.replaceChildren(...groups.map((group) => {
      const label = document.createElement('label'), input = document.createElement('input');
      label.append(`light of ${group.name} `, input);
      input.type = 'range', input.min = 0, input.max = 4, input.step = 0.01;
      input.oninput = () => later('gains', () =>
          send({type: 'display', gains: [...box.querySelectorAll('input')].map((each) => +each.value)}));
      return label;
    }));
  }
  [...box.querySelectorAll('input')].forEach((input, index) => put(input, groups[index].gain));
}

// The newest value after a pause, so that a slider sends no flood.
const waiting = new Map();
function later(name, action) {
  if (!waiting.has(name)) setTimeout(() => { const last = waiting.get(name); waiting.delete(name); last(); }, 60);
  waiting.set(name, action);
}
id('shown').onchange = () => send({type: 'display', shown: id('shown').value});
id('tonemap').onchange = () => send({type: 'display', tonemap: id('tonemap').value});
id('exposure').oninput = () => {
  id('auto-exposure').checked = false;
  later('exposure', () => send({type: 'display', exposure: +id('exposure').value}));
};
id('auto-exposure').onchange = () =>
    send({type: 'display', exposure: id('auto-exposure').checked ? 'auto' : +id('exposure').value});
id('width').onchange = id('height').onchange = () =>
    send({type: 'size', width: +id('width').value, height: +id('height').value});
id('fit').onclick = () => {
  const stage = getComputedStyle(id('stage')), ratio = window.devicePixelRatio || 1;
  const side = (length, padding) => Math.min(4096, Math.max(16, Math.floor((length - 2 * parseFloat(padding)) * ratio)));
  send({type: 'size', width: side(id('stage').clientWidth, stage.paddingLeft), height: side(id('stage').clientHeight, stage.paddingTop)});
};
id('target').onchange = () => send({type: 'target', error: Math.min(1, Math.max(0, +id('target').value / 100))});
id('environment').onchange = id('intensity').onchange = id('rotation').onchange = () =>
    send({type: 'environment', source: id('environment').value.trim(), intensity: +id('intensity').value,
      degrees: +id('rotation').value});
id('reset').onclick = () => send({type: 'camera', to: 'reset'});
id('frame').onclick = () => send({type: 'camera', to: 'frame'});

async function save(format) {
  const answer = await fetch(`picture.${format}`, {headers: {Authorization: `Bearer ${token}`}}).catch(() => null);
  if (!answer || !answer.ok) {
    bar(`Not saved: ${answer ? (await answer.text()).trim() : 'the server does not answer'}.`);
    return;
  }
  const link = document.createElement('a');
  link.href = URL.createObjectURL(await answer.blob());
  link.download = /filename="([^"]+)"/.exec(answer.headers.get('Content-Disposition') || '')?.[1] || `picture.${format}`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
  say(`Saved ${link.download}`);
}
id('save-png').onclick = () => save('png');
id('save-exr').onclick = () => save('exr');
id('copy').onclick = () => send({type: 'copy'});
async function takeLine(line) {
  id('line').hidden = false;
  id('line').value = line;
  try {
    await navigator.clipboard.writeText(line);
    say('The command is in the clipboard.');
  } catch {
    id('line').select(); // where a page may not reach the clipboard
    say('The command is selected; copy it.');
  }
}

function takePick(pick) {
  const number = (value) => value === null ? 'not finite' : (+value.toPrecision(5)).toString();
  const groups = new Map();
  for (const {name, value} of pick.values) {
    const key = ['R', 'G', 'B', 'A'].includes(name) ? 'radiance' : name.replace(/\.[^.]*$/, '');
    if (name !== 'A') groups.set(key, [...(groups.get(key) || []), number(value)]);
  }
  const rows = [['pixel', `${pick.pixel[0]}, ${pick.pixel[1]} at ${pick.spp} spp`], ['node', pick.node || 'none'],
    ['material', pick.material || 'none']];
  if (pick.point) {
    rows.push(['point, metres', pick.point.map(number).join(', ')]);
    rows.push(['distance, metres', number(pick.distance)]);
  }
  for (const [name, values] of groups) rows.push([name, values.join(', ')]);
  fill(id('pick'), rows);
  const box = canvas.getBoundingClientRect(), stage = id('stage').getBoundingClientRect(), marker = id('marker');
  marker.hidden = false;
  marker.style.left = `${box.left - stage.left + pick.at[0] * box.width}px`;
  marker.style.top = `${box.top - stage.top + pick.at[1] * box.height}px`;
}
const place = (event) => {
  const box = canvas.getBoundingClientRect();
  const within = (value) => Math.min(1, Math.max(0, value));
  return {x: within((event.clientX - box.left) / box.width), y: within((event.clientY - box.top) / box.height)};
};

// Steering: what happens between two messages goes into one.

const none = () => ({left: [0, 0], middle: [0, 0], right: [0, 0], scroll: 0});
let drag = none(), dragged = false, steering = null, lastSteer = 0;
const pointers = new Map(), held = new Set();
let downAt = null, wandered = false, shift = false, lastPlace = {x: 0.5, y: 0.5};

function flight() {
  const axis = (to, from) => (held.has(to) ? 1 : 0) - (held.has(from) ? 1 : 0);
  return [axis('KeyD', 'KeyA'), axis('KeyE', 'KeyQ'), axis('KeyW', 'KeyS')];
}
function schedule() {
  if (steering === null) steering = setTimeout(flush, Math.max(0, MOVE_PAUSE - (performance.now() - lastSteer)));
}
function flush() {
  steering = null;
  const now = performance.now(), fly = flight(), flies = fly.some((axis) => axis !== 0);
  if (steers && (dragged || flies))
    send({type: 'steer', ...drag, shift, fly, fast: shift, seconds: Math.min(0.1, (now - lastSteer) / 1000),
      dragging: pointers.size > 0});
  if (dragged || flies) id('marker').hidden = true;
  drag = none();
  dragged = false;
  lastSteer = now;
  if (flies) schedule();
}
function move(kind, x, y) {
  const height = canvas.getBoundingClientRect().height || 1;
  drag[kind][0] += x / height;
  drag[kind][1] += y / height;
  dragged = true;
  schedule();
}
canvas.addEventListener('pointerdown', (event) => {
  canvas.focus();
  canvas.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, {x: event.clientX, y: event.clientY, button: event.button});
  if (pointers.size === 1) downAt = event, wandered = false;
  else wandered = true;
  event.preventDefault();
});
canvas.addEventListener('pointermove', (event) => {
  lastPlace = place(event);
  const pointer = pointers.get(event.pointerId);
  if (!pointer) return;
  shift = event.shiftKey;
  if (pointers.size > 1 && event.pointerType === 'touch') {
    const [other] = [...pointers].filter(([key]) => key !== event.pointerId).map(([, value]) => value);
    const length = (x, y) => Math.max(1, Math.hypot(x - other.x, y - other.y));
    drag.scroll += Math.log(length(event.clientX, event.clientY) / length(pointer.x, pointer.y)) / 0.15;
    move('middle', (event.clientX - pointer.x) / 2, (event.clientY - pointer.y) / 2);
  } else {
    if (Math.hypot(event.clientX - downAt.clientX, event.clientY - downAt.clientY) > 3) wandered = true;
    if (wandered) move(['left', 'middle', 'right'][pointer.button] || 'left', event.clientX - pointer.x, event.clientY - pointer.y);
  }
  pointer.x = event.clientX;
  pointer.y = event.clientY;
});
function letGo(event) {
  if (!pointers.delete(event.pointerId)) return;
  if (event.type === 'pointerup' && !wandered && event.button === 0) send({type: 'pick', ...place(event)});
  if (pointers.size === 0 && wandered) dragged = true, schedule(); // tells that the pointer is free
}
canvas.addEventListener('pointerup', letGo);
canvas.addEventListener('pointercancel', letGo);
canvas.addEventListener('contextmenu', (event) => event.preventDefault());
canvas.addEventListener('dblclick', (event) => send({type: 'focus', ...place(event)}));
canvas.addEventListener('wheel', (event) => {
  drag.scroll -= Math.sign(event.deltaY) * Math.min(1, Math.abs(event.deltaY) / (event.deltaMode === 0 ? 100 : 1));
  dragged = true;
  schedule();
  event.preventDefault();
}, {passive: false});

const STEP = 0.04; // of the height of the picture, for a key
function turn(x, y) {
  const kind = shift ? 'middle' : 'left';
  drag[kind][0] += x * STEP;
  drag[kind][1] += y * STEP;
  dragged = true;
  shift = false;
  schedule();
}
const KEYS = {
  ArrowLeft: () => turn(-1, 0), ArrowRight: () => turn(1, 0), ArrowUp: () => turn(0, -1), ArrowDown: () => turn(0, 1),
  '+': () => { drag.scroll += 1; dragged = true; schedule(); }, '-': () => { drag.scroll -= 1; dragged = true; schedule(); },
  Home: () => send({type: 'camera', to: 'frame'}), r: () => send({type: 'camera', to: 'reset'}),
  f: () => send({type: 'focus', ...lastPlace}), i: () => send({type: 'pick', x: 0.5, y: 0.5}),
  c: () => send({type: 'copy'}), p: () => save('png'), x: () => save('exr'), h: () => togglePanel()
};
canvas.addEventListener('keydown', (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  shift = event.shiftKey;
  if (/^Key[WASDQE]$/.test(event.code)) {
    if (!held.size) lastSteer = performance.now();
    held.add(event.code);
    schedule();
  } else if (/^[1-9]$/.test(event.key)) {
    send({type: 'camera', to: String(event.key - 1)});
  } else {
    const action = KEYS[event.key] || KEYS[event.key.toLowerCase()];
    if (!action) return;
    action();
  }
  event.preventDefault();
});
canvas.addEventListener('keyup', (event) => { held.delete(event.code); shift = event.shiftKey; });
canvas.addEventListener('blur', () => held.clear());

function togglePanel() {
  const hides = document.body.classList.toggle('no-panel');
  id('toggle').textContent = hides ? 'Show panel' : 'Hide panel';
  id('toggle').setAttribute('aria-expanded', String(!hides));
}
id('toggle').onclick = togglePanel;
steer(false);
connect();
