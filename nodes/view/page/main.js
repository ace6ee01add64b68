'use strict';
// The socket, the keys, and who draws when. `window.voxtouch` reports to tests what has been drawn.
(function () {
  const $ = id => document.getElementById(id);
  const query = new URLSearchParams(location.search), token = query.get('token') || '';  // &smooth: for pictures, also where that takes long
  const state = window.voxtouch = {frame: null, facts: null, scene: null, frames: 0, pictures: 0, connected: false};
  let socket = null, refusal = '', paused = false, frameAt = 0, firstFacts = true, retry = 250, waiting = null, chartsDirty = false, chartsAt = 0, histogramAt = 0;

  const theme = localStorage.getItem('voxtouch-theme') || (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');
  document.documentElement.dataset.theme = theme;

  let scene3d = null;
  try {
    scene3d = state.scene3d = new Scene3D($('canvas'), $('labels'), query.has('smooth'));
  } catch (error) {
    $('note').textContent = `No 3-D view: this browser has no WebGL (${error.message}).`;
  }
  const charts = new Charts($('charts'), hold => setPaused(hold));
  const effects = new Panels.Effects(send);
  const hand = state.hand = scene3d && new Hand(scene3d, order => socket && socket.readyState === WebSocket.OPEN && socket.send(JSON.stringify(order)), () => state.connected && state.frame);

  const sound = state.sound = new Sound();
  const learn = new Learn({send, look: where => look(where), slice: axis => { cut.axis = axis, askSlice(); }, shell: () => showShell(true)});

  function send(order) {
    if (socket && socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(order));
    else effects.say('Not sent: the connection to the server is lost.', false);
  }

  function connect() {
    socket = new WebSocket(`ws://${location.host}/ring?token=${encodeURIComponent(token)}`, 'voxtouch-view');
    socket.onopen = () => { state.connected = true, firstFacts = true, refusal = ''; pill(); if (cut.axis) askSlice(); };
    socket.onmessage = event => {
      take(JSON.parse(event.data));
      if (!refusal) retry = 250;
    };
    socket.onclose = () => {
      state.connected = false;
      pill();
      setTimeout(connect, retry);
      retry = Math.min(4000, 2 * retry);
    };
  }

  function take(message) {
    if (message.type === 'frame') takeFrame(message);
    else if (message.type === 'facts') takeFacts(message);
    else if (message.type === 'scene') takeScene(message);
    else if (message.type === 'past') takePast(message);
    else if (message.type === 'answer') effects.answered(message);
    else if (message.type === 'slice') takeSlice(message);
    else if (message.type === 'shell') takeShell(message);
    else if (message.type === 'choice' || message.type === 'saved') learn.answered(message);
    else if (message.type === 'refused') refusal = message.sentence;
    else if (message.type === 'page' && hand) hand.page = state.page = message.page, hand.position = hand.aimed = null;
  }

  function takeScene(scene) {
    state.scene = scene;
    if (scene3d) scene3d.setScene(scene);
    showShell(shellOn);  // of this scene's tool
    $('what').textContent = scene.name || 'waiting for a scene';
    note();
  }

  // --- the tool's pointshell
  let shellOn = false;
  function showShell(on) {
    shellOn = on;
    $('shell').setAttribute('aria-pressed', String(on));
    for (const e of document.querySelectorAll('.of-shell')) e.hidden = !on;
    if (on) send({shell: true});
    else if (scene3d) scene3d.setShell(null);
  }
  function takeShell(message) {
    if (shellOn && scene3d) scene3d.setShell(message.points);
  }
  $('shell').addEventListener('click', () => showShell(!shellOn));

  // --- a plane through the voxels, found by the page's server
  const cut = {axis: '', follow: true, at: 0};
  function askSlice() {
    send({slice: cut.axis ? {axis: cut.axis, ...(cut.follow ? {} : {at: cut.at})} : null});
    for (const e of document.querySelectorAll('.of-slice')) e.hidden = !cut.axis;
    $('slice').value = cut.axis, $('slice-at').hidden = $('slice-follow').hidden = !cut.axis;
    $('slice-follow').setAttribute('aria-pressed', String(cut.follow));
    if (!cut.axis) state.slice = null, scene3d && scene3d.setSlice(null);
    if (cut.axis && scene3d) {
      const [low, high] = scene3d.rangeAlong(cut.axis);
      Object.assign($('slice-at'), {min: low, max: high, step: (high - low) / 500});
    }
  }
  function takeSlice(slice) {
    if (slice.axis !== cut.axis) return;  // of another page
    state.slice = slice;
    if (scene3d) scene3d.setSlice(slice);
    if (cut.follow) $('slice-at').value = slice.at;
    $('slice-text').textContent = `at ${slice.axis} = ${(1000 * slice.at).toFixed(1)} mm, cells of ${+(1000 * slice.step).toPrecision(3)} mm` +
      (slice.step > 1.001 * slice.voxel ? `, every ${Math.round(slice.step / slice.voxel)}th voxel` : '');
  }
  $('slice').addEventListener('change', () => { cut.axis = $('slice').value, askSlice(); });
  $('slice-follow').addEventListener('click', () => { cut.follow = !cut.follow, cut.at = Number($('slice-at').value), askSlice(); });
  let slicedAt = 0;
  $('slice-at').addEventListener('input', event => {
    cut.follow = false, cut.at = Number($('slice-at').value);
    if (performance.now() - slicedAt < 100 && event.type === 'input') return;
    slicedAt = performance.now();
    askSlice();
  });
  $('slice-at').addEventListener('change', () => { cut.at = Number($('slice-at').value), askSlice(); });

  function takePast(past) {
    if (paused && !isBag()) return;
    charts.replace(past.rows);
    chartsDirty = true;
  }

  function takeFrame(frame) {
    frameAt = performance.now();
    state.frames++;
    if (state.frame && state.frame.session !== frame.session) {
      charts.clear();
      if (hand) hand.position = hand.aimed = null;
    }
    state.frame = frame;
    if (state.facts && state.facts.device) sound.take(frame.rows, state.facts.device.max_force_n);
    if (paused && !isBag()) return;
    waiting = frame;
    charts.add(frame.rows);
    chartsDirty = true;
  }

  function takeFacts(facts) {
    state.facts = facts;
    const plan = facts.plan, device = facts.device, about = [];
    const scene = plan ? plan.scene : state.scene && state.scene.name;
    if (scene) about.push(`scene ${scene}`);
    if (plan) about.push(plan.virtual_tool ? 'virtual tool' : `contact model ${plan.model}`, `voxel ${+(1000 * plan.voxel_size_m).toPrecision(3)} mm`);
    if (device) about.push(`device ${device.model}, ${device.max_force_n} N at most${device.lockstep ? ', lockstep' : ''}`);
    if (facts.rig !== 'haptic') about.push(`rig ${facts.rig}`);
    $('what').textContent = $('what').title = about.join(' · ') || 'waiting for a scene';
    document.title = scene ? `${scene} – voxtouch` : 'voxtouch';
    Panels.showNodes(facts.nodes);
    Panels.showCounts(facts.counts, facts.nodes);
    Panels.showDesign(facts.design);
    effects.answers(facts.answers, firstFacts);
    effects.show(facts.effects, isBag());
    firstFacts = false;
    if (performance.now() - histogramAt > 450) {
      histogramAt = performance.now();
      if (!paused) charts.histogram.show(facts.latency, facts.counts, isBag(), Boolean(device && device.lockstep));
    }
    if (facts.bag) showPlayer(facts.bag);
    if (hand) hand.take(facts.hand);
    learn.take(facts);
    note(), pill();
  }

  function note() {
    if (!scene3d) return;
    const notes = state.scene ? state.scene.notes.slice() : [];
    if (state.facts && state.facts.bag_note) notes.unshift(state.facts.bag_note);
    if (state.facts && state.facts.scene_note) notes.push(state.facts.scene_note);
    $('note').textContent = notes.join(' ');
  }

  const isBag = () => Boolean(state.facts && state.facts.bag);

  function pill() {
    const say = (word, text) => { $('pill').dataset.state = word, $('pill').textContent = text; };
    if (!state.connected) return say('bad', refusal || 'no server: reconnecting');
    document.body.classList.remove('stale');
    if (isBag()) {
      const {playing, speed, verdict} = state.facts.bag;
      $('pill').title = !verdict ? 'The recording has no verdict' : verdict.problems.join(' ');
      const judged = !verdict ? '' : verdict.good ? ', passed' : ', failed';
      return say(verdict && !verdict.good ? 'bad' : 'live', (playing ? `recording × ${speed}` : 'recording, paused') + judged);
    }
    const silent = (performance.now() - frameAt) / 1000;
    document.body.classList.toggle('stale', state.frame !== null && silent > 1.5 && !isBag());
    if (state.frame === null) return say('wait', 'waiting for a ring');
    if (silent > 1.5) return say('wait', `no samples for ${silent.toFixed(0)} s`);
    if (paused) return say('wait', 'paused on this page; the ring continues');
    const device = state.facts && state.facts.nodes.find(n => n.node === 'device');
    say('live', device && device.rate_hz ? `live, ${device.rate_hz.toFixed(0)} Hz` : 'live');
  }

  function setPaused(on) {
    if (isBag()) return void (on && state.facts.bag.playing && send({play: false}));
    paused = on;
    $('pause').setAttribute('aria-pressed', String(on));
    $('pause').textContent = on ? 'Continue' : 'Pause';
    if (!on) charts.window = null, send({past: true});
    pill();
  }

  function toggle() {
    if (isBag()) {
      charts.window = null;
      send({play: !state.facts.bag.playing});
    } else {
      setPaused(!paused);
    }
  }

  // --- a recorded run
  let seeking = false;
  function showPlayer(bag) {
    document.body.classList.add('bag');
    $('player').hidden = false, $('pause').hidden = true;
    $('play').textContent = bag.playing ? 'Pause' : 'Play';
    $('seek').max = bag.duration;
    if (!seeking) $('seek').value = bag.t;
    $('clock').textContent = `${bag.t.toFixed(1)} / ${bag.duration.toFixed(1)} s`;
    if (document.activeElement !== $('speed')) $('speed').value = String(bag.speed);
  }
  $('player').addEventListener('submit', event => event.preventDefault());
  $('play').addEventListener('click', toggle);
  $('seek').addEventListener('pointerdown', () => { seeking = true; });
  for (const end of ['pointerup', 'pointercancel']) $('seek').addEventListener(end, () => { seeking = false; });
  let seekAt = 0;
  $('seek').addEventListener('input', () => {
    if (performance.now() - seekAt < 60) return;
    seekAt = performance.now();
    charts.window = null;
    send({seek: Number($('seek').value)});
  });
  $('seek').addEventListener('change', () => send({seek: Number($('seek').value)}));
  $('speed').addEventListener('change', () => send({speed: Number($('speed').value)}));

  // --- buttons and keys
  function switchTheme() {
    const next = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark';
    document.documentElement.dataset.theme = next;
    localStorage.setItem('voxtouch-theme', next);
    if (scene3d) scene3d.recolor(), scene3d.setSlice(state.slice || null);
    charts.recolor();
    histogramAt = 0, chartsDirty = true;
  }
  function see() {
    if (scene3d) $('through').setAttribute('aria-pressed', String(scene3d.toggleThrough()));
  }
  const look = where => { if (scene3d) scene3d.look(where); };
  $('pause').addEventListener('click', toggle);
  $('theme').addEventListener('click', switchTheme);
  $('through').addEventListener('click', see);
  $('help').addEventListener('click', () => $('keys').showModal());
  $('close-keys').addEventListener('click', () => $('keys').close());
  for (const button of document.querySelectorAll('[data-camera]')) button.addEventListener('click', () => look(button.dataset.camera));
  const toggleHand = () => hand && hand.facts && hand.setOn(!hand.on);
  $('hand-on').addEventListener('click', toggleHand);
  const step = by => isBag() && send({seek: Math.max(0, state.facts.bag.t + by)});
  const KEYS = {' ': toggle, l: () => learn.toggle(), m: () => sound.setOn(!sound.on), h: toggleHand, t: switchTheme, o: see, '?': () => $('keys').showModal(), ArrowLeft: () => step(-1), ArrowRight: () => step(1),
                p: () => showShell(!shellOn),
                v: () => { cut.axis = {'': 'x', x: 'y', y: 'z', z: ''}[cut.axis], askSlice(); },
                0: () => look('home'), 1: () => look('front'), 2: () => look('side'), 3: () => look('top'), 4: () => look('near')};
  document.addEventListener('keydown', event => {
    if (event.ctrlKey || event.metaKey || event.altKey || $('keys').open) return;
    if (event.target.closest('input, select, button, summary, textarea') && (event.key === ' ' || event.key.startsWith('Arrow') || event.target.matches('input[type="text"], select'))) return;
    if (hand && hand.key(event)) return void event.preventDefault();
    const act = KEYS[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });

  // --- drawing: the picture as often as the browser can, the charts ten times a second
  function showNumbers(frame) {
    const size = v => v ? Math.hypot(...v).toFixed(2) : '–';
    $('n-force').textContent = size(frame.force), $('n-contact').textContent = size(frame.contact_force);
    $('n-depth').textContent = frame.depth === undefined || frame.depth === null ? '–' : (1000 * frame.depth).toFixed(2);
    // A virtual tool stays outside: the points in contact are those that the page's server finds.
    const isVirtual = state.facts && state.facts.plan && state.facts.plan.virtual_tool;
    $('n-hits').textContent = isVirtual && frame.points ? frame.points.length / 3 : frame.hits ?? '–';
    const words = [...(frame.flags || []), ...(frame.limits || [])];
    if ($('flags').dataset.words !== words.join()) {
      $('flags').dataset.words = words.join();
      $('flags').replaceChildren(...words.map(w => Object.assign(document.createElement('span'), {textContent: w})));
    }
  }
  function draw() {
    if (hand) hand.step(performance.now());
    if (waiting) {
      if (scene3d) scene3d.setFrame(waiting), $('scales').textContent = scene3d.scaleText();
      showNumbers(waiting);
      if (hand && state.facts && state.facts.device) hand.rumble(Math.hypot(...(waiting.force || [0])) / state.facts.device.max_force_n, performance.now());
      waiting = null;
    }
    if (scene3d && scene3d.draw()) state.pictures++;
    if (chartsDirty && performance.now() - chartsAt > 100) {
      chartsDirty = false, chartsAt = performance.now();
      charts.draw();
    }
    requestAnimationFrame(draw);
  }
  setInterval(pill, 500);
  setInterval(() => hand && hand.step(performance.now()), 50);  // a page that draws slowly leads the hand all the same
  connect();
  requestAnimationFrame(draw);
})();
