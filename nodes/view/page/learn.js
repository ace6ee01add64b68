'use strict';
// The panel Learn: scene and device, the contact model, a tour of six steps, a mesh by drag and drop, and sound.
(function () {
  const $ = id => document.getElementById(id);
  const option = (value, text) => Object.assign(document.createElement('option'), {value, textContent: text ?? value});

  // Hints for each model and effect.
  const MODELS = {
    original: 'A tangent plane for each voxel: it chatters at voxel borders. Slide slowly.',
    adapted: 'Planes with mean normals: softer steps than original. Slide slowly over the same place.',
    field: 'An interpolated distance: smooth, and soft at sharp edges.',
  };
  const VIRTUAL_TOOL = 'A virtual tool stays on the surface of the mesh, and a spring pulls the hand to it: press, and slide round an edge.';
  const EFFECTS = {
    friction: 'Press and slide: the force leans back, and the tool sticks before it slips.',
    texture: 'Slide at an even speed: the ripple gets faster with the speed.',
    viscosity: 'Move fast in free space: the drag grows with the speed.',
    magnet: 'Come close and let go: it pulls you in.',
    proximity: 'Come close without contact: the force begins before the surface.',
  };
  // Title, what to do and to feel for, and what "Show it" does.
  const TOUR = [
    ['Voxels', 'In the scene "cup" the force comes from a grid of voxels. Move the tool through the plane: it begins at the surface voxels.',
     page => { page.leaveVirtualTool(), page.slice('y'); }],
    ['Pointshell', 'The tool is a shell of points. Press lightly, then harder: the force grows with the number of points in contact.',
     page => { page.leaveVirtualTool(), page.look('near'), page.shell(); }],
    ['Models', 'Three models compute the same contact. Slide slowly over one place, and choose each of them under "Contact model".',
     page => page.choose({scene: 'cup'})],
    ['Coupling', '"Show it" switches the coupling\'s filter off and on, each with the stiffness that is certified for it. '
      + 'Press and slide: without the filter the wall is harder, and its voxels are rougher.', page => page.switchCoupling()],
    ['Friction', 'Press, slide, and switch friction off and on in "Effects": the force leans back while it is on.',
     page => page.choose({scene: 'cup_friction'})],
    ['Your mesh', 'Drop an OBJ, STL, PLY or GLB file of at most 16 MiB on the picture: feel its edges. A separate process reads it, with limits.',
     page => page.pickMesh()],
  ];

  class Learn {
    // `page`: {send(order), slice(axis), shell(), look(where)}
    constructor(page) {
      this.page = page, this.step = 0, this.offered = false, this.scene = '', this.virtual = false;
      page.leaveVirtualTool = () => this.virtual && this.choose({scene: 'cup'});
      page.choose = choice => this.choose(choice), page.pickMesh = () => $('mesh').click();
      page.switchCoupling = () => this.choose({scene: this.scene === 'cup_direct' ? 'cup' : 'cup_direct'});
      $('save').addEventListener('click', () => this.save());
      $('learn-on').addEventListener('click', () => this.toggle());
      $('start').addEventListener('click', () => this.choose({}));
      $('model').addEventListener('change', () => this.page.send({model: $('model').value}));
      $('tour-back').addEventListener('click', () => this.go(-1));
      $('tour-next').addEventListener('click', () => this.go(1));
      $('tour-do').addEventListener('click', () => TOUR[this.step][2](this.page));
      $('mesh').addEventListener('change', () => this.sendMesh($('mesh').files[0]));
      for (const kind of ['dragover', 'drop']) $('scene').addEventListener(kind, event => {
        event.preventDefault();
        if (kind === 'drop') this.sendMesh(event.dataTransfer.files[0]);
      });
      $('model').append(...Object.keys(MODELS).map(name => option(name)));
      this.go(0);
    }

    toggle() {
      const on = $('learn').hidden;
      $('learn').hidden = !on;
      $('learn-on').setAttribute('aria-pressed', String(on));
      if (on) $('tour-do').focus();
    }
    go(by) {
      this.step = Math.max(0, Math.min(TOUR.length - 1, this.step + by));
      const [title, text] = TOUR[this.step];
      $('tour-title').textContent = `Step ${this.step + 1} of ${TOUR.length}: ${title}`, $('tour-text').textContent = text;
      $('tour-back').disabled = this.step === 0, $('tour-next').disabled = this.step === TOUR.length - 1;
    }
    say(text) { $('learn-text').textContent = text; }

    take(facts) {
      const {offered, plan, device, effects} = facts;
      $('choice').hidden = !offered, $('save').hidden = !facts.saves;
      if (offered && !this.offered) {
        for (const [id, names] of [['choose-scene', offered.scenes], ['choose-device', offered.devices]]) $(id).replaceChildren(...names.map(name => option(name)));
        this.offered = true;
      }
      const snapshot = JSON.stringify([plan, device]);
      if (plan && snapshot !== this.snapshot) {
        this.snapshot = snapshot;
        this.scene = $('choose-scene').value = plan.scene, $('model').value = plan.model;
        this.virtual = $('model').disabled = Boolean(plan.virtual_tool);
        if (device && offered && offered.devices.includes(device.model)) $('choose-device').value = device.model;
        this.say('');
      }
      const on = effects.filter(e => e.on).map(e => EFFECTS[e.name]).filter(Boolean);
      $('feel').textContent = [this.virtual ? VIRTUAL_TOOL : MODELS[plan && plan.model], ...on].filter(Boolean).join(' ');
    }

    choose(choice) {
      if (!this.offered) return this.say('Scene and device are chosen at the start of this ring.');
      const chosen = {scene: $('choose-scene').value, device: $('choose-device').value || 'sim-phantom', ...choice};
      this.page.send({choose: chosen});
      this.say(`${chosen.scene} on ${chosen.device} is checked; then the ring starts again.`);
    }
    answered(message) { this.say(message.sentence); }
    save() {
      this.page.send({save: true});
      this.say('The last ten seconds are being saved.');
    }

    // In pieces of 30 kB, thirty a second.
    async sendMesh(file) {
      if (!file || !this.offered) return this.say('A mesh can be chosen where voxtouch try runs the ring.');
      const ending = file.name.slice(file.name.lastIndexOf('.')).toLowerCase(), device = $('choose-device').value || 'sim-phantom';
      if (!file.size) return this.say('The file is empty.');
      if (file.size > 16 << 20) return this.say('The file is larger than 16 MiB.');
      const bytes = new Uint8Array(await file.arrayBuffer()), piece = 30000;
      for (let at = 0; at < bytes.length; at += piece) {
        if (at) await new Promise(done => setTimeout(done, 33));
        this.say(`${file.name}: ${Math.round(100 * at / bytes.length)} % sent`);
        this.page.send({mesh: {ending, device, at, of: bytes.length, data: btoa(String.fromCharCode(...bytes.subarray(at, at + piece)))}});
      }
      this.say(`${file.name} is read; then the ring starts again.`);
    }
  }

  const ROW_S = 0.008, FREE_S = 0.1;  // a contact that clicks follows so long in free space

  // Loudness by the force, a click at contact, and what the force does from row to row: a texture, a chatter. Off until it is switched on.
  class Sound {
    constructor() {
      this.on = false, this.end = this.force = this.free = 0;
      $('sound').addEventListener('click', () => this.setOn(!this.on));
    }
    setOn(on) {
      this.on = on;
      $('sound').setAttribute('aria-pressed', String(on));
      if (!this.context) this.make();
      if (on) this.context.resume();
      else this.context.suspend();
    }
    make() {
      const context = this.context = new AudioContext(), noise = context.createBuffer(1, context.sampleRate, context.sampleRate);
      const samples = noise.getChannelData(0);
      for (let n = 0; n < samples.length; ++n) samples[n] = 2 * Math.random() - 1;
      this.noise = noise;
      this.out = context.createGain(), this.out.connect(context.destination);
      const source = (node, level) => {
        const out = context.createGain();
        out.gain.value = level, node.connect(out).connect(this.out), node.start();
        return out.gain;
      };
      const hum = Object.assign(context.createOscillator(), {type: 'triangle'});
      hum.frequency.value = 110;
      this.hum = source(hum, 0);
      this.rough = source(Object.assign(context.createBufferSource(), {buffer: noise, loop: true}), 0);
    }
    // An analyser of the output.
    listen() {
      const ear = this.context.createAnalyser();
      this.out.connect(ear);
      return ear;
    }
    // `rows`: of charts.js, each played for as long as it lasted, however late its frame is; `largest`: force of the device [N].
    take(rows, largest) {
      if (!this.on) return;
      const now = this.context.currentTime;
      let at = Math.min(Math.max(now + 0.01, this.end), now + 0.1);
      for (const gain of [this.hum, this.rough]) gain.cancelScheduledValues(at);
      for (const [, , , , force, contact] of rows) {
        const ratio = Math.min(1, force / largest), change = contact > 0 ? Math.abs(force - this.force) : 0;
        this.hum.setTargetAtTime(0.25 * ratio, at, 0.02);
        this.rough.setTargetAtTime(Math.min(0.2, 2 * change), at, 0.003);
        if (contact > 0 && this.free > FREE_S) this.click(at, ratio);
        this.free = contact > 0 ? 0 : this.free + ROW_S;
        this.force = force, at += ROW_S;
      }
      this.end = at;
      this.rough.setTargetAtTime(0, at, 0.003), this.hum.setTargetAtTime(0, at + 0.3, 0.05);  // if no frame comes any more
    }
    click(now, ratio) {
      const source = Object.assign(this.context.createBufferSource(), {buffer: this.noise}), level = this.context.createGain();
      level.gain.setValueAtTime(0.3 + 0.3 * ratio, now), level.gain.exponentialRampToValueAtTime(1e-3, now + 0.03);
      source.connect(level).connect(this.out);
      source.start(now, Math.random(), 0.03);
    }
  }

  window.Learn = Learn, window.Sound = Sound;
})();
