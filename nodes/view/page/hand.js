'use strict';
// The hand of a simulated device, led by mouse, pen, touch, wheel, keys or gamepad. What is dragged is where the hand wants to be.
// `window.Hand` turns input into targets of the tool in W and sends them; it uses no socket.
(function () {
  const $ = id => document.getElementById(id);
  const SEND_MS = 1000 / 60, KEEP_MS = 100, AFTER_MS = 1500;  // without a target for 300 ms the hand rests
  const MOVES = {ArrowLeft: ['right', -1], ArrowRight: ['right', 1], ArrowUp: ['up', 1], ArrowDown: ['up', -1], PageUp: ['away', 1], PageDown: ['away', -1]};
  const TURNS = {ArrowLeft: ['up', -1], ArrowRight: ['up', 1], ArrowUp: ['right', -1], ArrowDown: ['right', 1], PageUp: ['away', 1], PageDown: ['away', -1]};
  const DEAD = 0.15;  // of a gamepad's stick

  class Hand {
    // `scene`: a Scene3D; `send(order)`; `frame()`: the newest frame, or nothing.
    constructor(scene, send, frame) {
      this.scene = scene, this.send = send, this.frame = frame;
      this.page = null, this.facts = null, this.on = false;
      this.position = null, this.orientation = new THREE.Quaternion();  // to where it was dragged; null: nowhere yet
      this.aimed = null;                                                // what was sent last
      this.pointers = new Map(), this.keys = new Set(), this.shift = false;
      this.dirty = false, this.sentAt = -1e9, this.nextAt = 0, this.heldAt = -1e9, this.movedAt = performance.now(), this.pad = false;
      const canvas = scene.canvas;
      canvas.addEventListener('pointerdown', event => this.down(event));
      canvas.addEventListener('pointermove', event => this.move(event));
      for (const end of ['pointerup', 'pointercancel', 'lostpointercapture']) canvas.addEventListener(end, event => this.up(event));
      canvas.addEventListener('wheel', event => this.wheel(event), {passive: false});
      canvas.addEventListener('contextmenu', event => this.on && event.preventDefault());
      for (const end of ['blur', 'pagehide']) window.addEventListener(end, () => this.letGo());
      document.addEventListener('visibilitychange', () => document.hidden && this.letGo());
      document.addEventListener('keyup', event => { this.keys.delete(event.key), this.shift = event.shiftKey; });
    }

    // --- control of the hand
    take(facts) {
      const before = this.facts;
      this.facts = facts;
      if (!facts) return;
      if (!before) this.setOn(true), $('hand-panel').hidden = false;
      for (const e of document.querySelectorAll('.of-hand')) e.hidden = false;
      if (!this.isHeld() && facts.page !== null && facts.page !== this.page) this.position = this.aimed = null;  // another one moves it
      $('hand-text').textContent = facts.page === null ? 'No page controls the hand: drag the tool, or use the arrow keys.'
        : facts.page === this.page ? 'This page controls the hand.' : `Page ${facts.page} controls the hand; this is page ${this.page}.`;
      this.show();
    }
    isMine() { return this.facts !== null && (this.facts.page === null || this.facts.page === this.page); }

    setOn(on) {
      this.on = on;
      if (!on) this.letGo();
      this.scene.controls.enabled = !on;
      this.scene.canvas.style.touchAction = on ? 'none' : '';
      $('hand-on').setAttribute('aria-pressed', String(on));
      this.scene.canvas.setAttribute('aria-label', on
        ? 'The scene in 3-D: drag to move the hand, wheel for depth, right button or Shift to rotate; arrow keys, Page Up and Page Down'
        : 'The scene in 3-D: drag to rotate, wheel to zoom, right button to shift');
    }
    letGo() { this.pointers.clear(), this.keys.clear(), this.shift = false; }
    isHeld() { return this.pointers.size > 0 || this.keys.size > 0 || this.pad; }

    // --- from the screen to W
    axes() {
      const m = this.scene.camera.matrixWorld.elements, v = n => new THREE.Vector3(m[n], m[n + 1], m[n + 2]);
      return {right: v(0), up: v(4), away: v(8).negate()};
    }
    // Length in W of one pixel at the target.
    pixel() {
      const camera = this.scene.camera, depth = this.position.clone().sub(camera.position).dot(this.axes().away);
      return 2 * Math.max(depth, camera.near) * Math.tan(camera.fov * Math.PI / 360) / Math.max(1, this.scene.canvas.clientHeight);
    }
    // The target begins where it was left, or at the tool.
    grip() {
      const tool = this.tool(), last = this.facts && this.facts.target;
      if (!this.on || !this.isMine() || !tool) return false;
      this.heldAt = performance.now();
      if (this.position) return true;
      const at = last && this.near(last, tool) ? last : tool;
      this.position = new THREE.Vector3(at[0], at[1], at[2]);
      this.orientation.set(at[3], at[4], at[5], at[6]).normalize();
      return true;
    }
    near(a, b) { return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) < this.sight(); }
    sight() { return 0.6 * this.scene.radius; }
    tool() { const frame = this.frame(); return frame && frame.tool; }
    // In sight of the tool, however long it is dragged into a wall; how hard it presses is for the device to limit.
    shiftBy(axis, length) {
      const tool = this.tool();
      this.position.addScaledVector(this.axes()[axis], length);
      if (tool) {
        const from = new THREE.Vector3(tool[0], tool[1], tool[2]);
        this.position.sub(from).clampLength(0, this.sight()).add(from);
      }
      this.changed();
    }
    turnBy(axis, angle) {
      this.orientation.premultiply(new THREE.Quaternion().setFromAxisAngle(this.axes()[axis], angle)).normalize();
      this.changed();
    }
    changed() {
      this.dirty = true, this.heldAt = performance.now();
      this.flush(this.heldAt), this.show();
    }

    // --- mouse, pen, touch
    down(event) {
      if (!this.grip()) return;
      event.preventDefault();
      this.scene.canvas.focus({preventScroll: true});
      try { this.scene.canvas.setPointerCapture(event.pointerId); } catch { /* the pointer has gone meanwhile */ }
      this.pointers.set(event.pointerId, {x: event.clientX, y: event.clientY, pressure: event.pressure, turns: event.button === 2});
      this.changed();
    }
    move(event) {
      const last = this.pointers.get(event.pointerId);
      if (!last || !this.grip()) return;
      event.preventDefault();
      const dx = event.clientX - last.x, dy = event.clientY - last.y, pixel = this.pixel();
      if (this.pointers.size === 2) this.moveTwo(event, last, dx, dy, pixel);
      else if (last.turns || event.shiftKey) this.turnBy('up', 0.008 * dx), this.turnBy('right', 0.008 * dy);
      else this.shiftBy('right', dx * pixel), this.shiftBy('up', -dy * pixel);
      if (event.pointerType === 'pen' && this.pointers.size === 1) this.shiftBy('away', 0.25 * this.scene.radius * (event.pressure - last.pressure));
      last.x = event.clientX, last.y = event.clientY, last.pressure = event.pressure;
    }
    // Two fingers: what they do together rotates, what they do against each other goes in depth.
    moveTwo(event, last, dx, dy, pixel) {
      const other = [...this.pointers].find(([id]) => id !== event.pointerId)[1];
      const length = (x, y) => Math.hypot(x - other.x, y - other.y);
      this.shiftBy('away', (length(last.x, last.y) - length(event.clientX, event.clientY)) * pixel);
      this.turnBy('up', 0.004 * dx), this.turnBy('right', 0.004 * dy);
    }
    up(event) { this.pointers.delete(event.pointerId); }
    wheel(event) {
      if (!this.grip()) return;
      event.preventDefault();
      const lines = event.deltaMode === 1 ? 16 : event.deltaMode === 2 ? 120 : 1;
      this.shiftBy('away', -0.3 * event.deltaY * lines * this.pixel());
    }

    // --- keys: a press is a small step, a key that is held goes on
    key(event) {
      if (!MOVES[event.key] || !this.grip()) return false;
      this.shift = event.shiftKey;
      if (!this.keys.has(event.key)) this.goAlong(event.key, 0.025);
      this.keys.add(event.key);
      return true;
    }
    goAlong(key, seconds) {
      const [axis, sign] = (this.shift ? TURNS : MOVES)[key];
      if (this.shift) this.turnBy(axis, sign * 1.0 * seconds);
      else this.shiftBy(axis, sign * 0.5 * this.scene.radius * seconds);
    }

    // --- gamepad: left stick in the plane of the screen, triggers in depth, right stick rotates
    readPad(seconds) {
      // Of another layout a trigger at rest may be an axis at -1.
      const pad = navigator.getGamepads && [...navigator.getGamepads()].find(p => p && p.mapping === 'standard');
      const bend = x => Math.abs(x) < DEAD ? 0 : (x - Math.sign(x) * DEAD) / (1 - DEAD);
      if (!pad) return void (this.pad = false);
      const [x, y, u, v] = [0, 1, 2, 3].map(n => bend(pad.axes[n] || 0));
      const depth = (pad.buttons[7] ? pad.buttons[7].value : 0) - (pad.buttons[6] ? pad.buttons[6].value : 0);
      this.pad = [x, y, u, v, depth].some(a => a !== 0);
      if (!this.pad || !this.grip()) return;
      const speed = 0.9 * this.scene.radius * seconds;
      if (x || y) this.shiftBy('right', speed * x), this.shiftBy('up', -speed * y);
      if (depth) this.shiftBy('away', speed * depth);
      if (u || v) this.turnBy('up', 1.5 * seconds * u), this.turnBy('right', 1.5 * seconds * v);
      this.padOf = pad;
    }
    // `ratio`: of the device's largest force.
    rumble(ratio, now) {
      const motor = this.padOf && this.padOf.vibrationActuator;
      if (!motor || ratio < 0.02 || now - (this.rumbledAt || 0) < 90) return;
      this.rumbledAt = now;
      motor.playEffect('dual-rumble', {duration: 100, strongMagnitude: Math.min(1, ratio), weakMagnitude: Math.min(1, 0.5 * ratio)}).catch(() => {});
    }

    // --- once a picture, and while the page is drawn seldom also from its timer
    step(now) {
      const seconds = Math.min(0.1, (now - this.movedAt) / 1000);
      this.movedAt = now;
      if (!this.on || !this.facts) return;
      this.readPad(seconds);
      if (this.keys.size && this.grip()) for (const key of this.keys) this.goAlong(key, seconds);
      if (this.isHeld()) this.heldAt = now;
      this.flush(now), this.show();
    }
    flush(now) {
      if (!this.position || !this.isMine() || now < this.nextAt - 2) return;
      if (!this.dirty && now - this.heldAt > AFTER_MS) return;
      if (!this.dirty && now - this.sentAt < KEEP_MS) return;
      this.dirty = false, this.sentAt = now, this.aimed = this.position.clone();
      this.nextAt = Math.max(this.nextAt, now - SEND_MS) + SEND_MS;  // sixty a second, however unevenly pictures come
      this.send({aim: {p: this.position.toArray(), q: this.orientation.toArray()}});
    }
    show() {
      const last = this.facts && this.facts.target;
      this.scene.setCursor(this.position && this.aimed ? this.aimed : (last ? new THREE.Vector3(last[0], last[1], last[2]) : null));
    }
  }
  window.Hand = Hand;
})();
