'use strict';
// The scene in 3-D: meshes, tool, hand, forces, trail, points in contact. `window.Scene3D` draws what it receives; it uses no socket.
// z is up, lengths are metres, as in the scene file.
(function () {
  const TRAIL_S = 5, MOST_TRAIL = 5 * 40, MOST_POINTS = 400;
  const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const color = name => new THREE.Color(css(name));
  const sized = (n, digits) => n.toFixed(digits);

  // Without a graphics card every pixel costs time that the ring on the same machine may need.
  function inSoftware() {
    const gl = document.createElement('canvas').getContext('webgl'), about = gl && gl.getExtension('WEBGL_debug_renderer_info');
    return Boolean(about) && /swiftshader|llvmpipe|software/i.test(gl.getParameter(about.UNMASKED_RENDERER_WEBGL));
  }

  // Faces that meet at less than 40 degrees share a normal: round things look round, and edges stay edges.
  function creased(positions, indices) {
    const limit = Math.cos(40 * Math.PI / 180), count = indices.length, faces = [], around = new Map();
    const a = new THREE.Vector3(), b = new THREE.Vector3(), c = new THREE.Vector3();
    for (let f = 0; f < count / 3; ++f) {
      const [i, j, k] = [indices[3 * f], indices[3 * f + 1], indices[3 * f + 2]];
      a.fromArray(positions, 3 * i), b.fromArray(positions, 3 * j), c.fromArray(positions, 3 * k);
      const normal = b.sub(a).cross(c.sub(a)).clone();  // its length is the face's weight
      faces.push({normal, unit: normal.clone().normalize()});
      for (const v of [i, j, k]) around.has(v) ? around.get(v).push(f) : around.set(v, [f]);
    }
    // A corner is one vertex for all faces that give it the same normal: what draws in software turns each vertex by itself.
    const sum = new THREE.Vector3(), out = [], normals = [], corners = new Uint32Array(count), known = new Map();
    for (let n = 0; n < count; ++n) {
      const face = faces[Math.floor(n / 3)], v = indices[n];
      sum.set(0, 0, 0);
      for (const other of around.get(v)) if (faces[other].unit.dot(face.unit) >= limit) sum.add(faces[other].normal);
      if (sum.lengthSq() === 0) sum.copy(face.unit);
      sum.normalize();
      const key = `${v} ${Math.round(500 * sum.x)} ${Math.round(500 * sum.y)} ${Math.round(500 * sum.z)}`;
      if (!known.has(key)) {
        known.set(key, out.length / 3);
        out.push(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]);
        normals.push(sum.x, sum.y, sum.z);
      }
      corners[n] = known.get(key);
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(out), 3));
    geometry.setAttribute('normal', new THREE.BufferAttribute(new Float32Array(normals), 3));
    geometry.setIndex(new THREE.BufferAttribute(corners, 1));
    return geometry;
  }

  // An arrow of unit length along +y that is drawn over everything: a force inside a cup is seen from outside.
  function arrow(size) {
    const group = new THREE.Group();
    const material = new THREE.MeshBasicMaterial({depthTest: false, transparent: true});
    const shaft = new THREE.Mesh(new THREE.CylinderBufferGeometry(size, size, 1, 12), material);
    const head = new THREE.Mesh(new THREE.ConeBufferGeometry(2.8 * size, 1, 16), material);
    group.add(shaft, head);
    group.renderOrder = shaft.renderOrder = head.renderOrder = 10;
    group.visible = false;
    group.userData = {material, set(from, vector, headLength) {
      const length = vector.length();
      group.visible = length > 1e-6;
      if (!group.visible) return;
      const h = Math.min(headLength, 0.6 * length);
      shaft.scale.set(1, Math.max(1e-9, length - h), 1), shaft.position.y = (length - h) / 2;
      head.scale.set(Math.max(0.5, h / headLength), h, Math.max(0.5, h / headLength)), head.position.y = length - h / 2;
      group.position.copy(from);
      group.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), vector.clone().divideScalar(length));
    }};
    return group;
  }

  class Scene3D {
    constructor(canvas, labels, smooth) {
      this.canvas = canvas;
      const slow = this.slow = inSoftware() && !smooth;
      this.mostPixels = slow ? 0.8 : 2;
      this.renderer = new THREE.WebGLRenderer({canvas, antialias: !slow, alpha: true});
      this.world = new THREE.Scene();
      this.camera = new THREE.PerspectiveCamera(38, 1, 0.001, 100);
      this.camera.up.set(0, 0, 1);
      this.controls = new THREE.OrbitControls(this.camera, canvas);
      this.controls.enableKeys = false;
      this.controls.addEventListener('change', () => { this.dirty = true; });
      this.controls.addEventListener('start', () => { this.follow = false; });
      this.light = new THREE.DirectionalLight(0xffffff, 0.65);
      this.world.add(new THREE.HemisphereLight(0xffffff, 0x889099, 0.62), this.light);
      this.statics = new THREE.Group(), this.tool = new THREE.Group(), this.ghost = new THREE.Group(), this.helpers = new THREE.Group();
      this.objects = new Map();
      this.world.add(this.statics, this.tool, this.ghost, this.helpers);
      this.tool.visible = this.ghost.visible = false;
      this.labels = {};
      for (const kind of ['returned', 'contact']) {
        const label = labels.appendChild(document.createElement('span'));
        label.className = kind, label.hidden = true;
        this.labels[kind] = label;
      }
      this.trail = [];
      this.trailLine = new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial());
      this.trailLine.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3 * MOST_TRAIL), 3));
      this.trailLine.frustumCulled = false;
      this.dots = new THREE.Points(new THREE.BufferGeometry(), new THREE.PointsMaterial({size: 3, sizeAttenuation: false, depthTest: false, transparent: true}));
      this.dots.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3 * MOST_POINTS), 3));
      this.dots.frustumCulled = false, this.dots.renderOrder = 9;
      this.world.add(this.trailLine, this.dots);
      this.cursor = new THREE.Mesh(new THREE.SphereBufferGeometry(1, 16, 10), new THREE.MeshBasicMaterial({wireframe: true, depthTest: false, transparent: true}));
      this.pull = new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({depthTest: false, transparent: true}));
      this.pull.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(6), 3));
      this.pull.frustumCulled = false;
      this.cursor.renderOrder = this.pull.renderOrder = 12;
      this.cursor.visible = this.pull.visible = false;
      this.world.add(this.cursor, this.pull);
      this.radius = 0.1, this.middle = new THREE.Vector3(), this.seeThrough = true, this.follow = false;
      this.metresPerNewton = 0.1, this.largest = [];
      this.makeArrows(), this.recolor();
    }

    makeArrows() {
      if (this.arrows) this.world.remove(this.arrows.returned, this.arrows.contact);
      this.arrows = {returned: arrow(0.018 * this.radius), contact: arrow(0.014 * this.radius)};
      for (const part of this.arrows.returned.children) part.renderOrder = 11;  // the shorter one lies on the longer one
      this.world.add(this.arrows.contact, this.arrows.returned);
    }

    setScene(scene) {
      for (const group of [this.statics, this.tool, this.ghost]) group.clear ? group.clear() : group.remove(...group.children);
      this.objects.clear(), this.shell = null;
      const box = new THREE.Box3(), toolBox = new THREE.Box3();
      for (const mesh of scene.meshes) {
        const geometry = creased(mesh.positions, mesh.indices);
        geometry.computeBoundingBox();
        if (mesh.role === 'dynamic') {
          this.tool.add(new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({side: THREE.DoubleSide})));
          this.ghost.add(new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({wireframe: true, transparent: true, opacity: 0.3, depthWrite: false})));
          toolBox.union(geometry.boundingBox);
          continue;
        }
        if (!this.objects.has(mesh.object)) {
          const group = new THREE.Group();
          this.objects.set(mesh.object, group), this.statics.add(group);
        }
        // The back of each surface first, then its front: what is seen through looks the same from all sides. In software at once: half the work.
        for (const side of this.slow ? [THREE.DoubleSide] : [THREE.BackSide, THREE.FrontSide]) {
          const part = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({side, transparent: true}));
          part.renderOrder = side === THREE.BackSide ? 1 : 2;
          this.objects.get(mesh.object).add(part);
        }
        box.union(geometry.boundingBox);
      }
      if (box.isEmpty()) box.copy(toolBox);
      if (box.isEmpty()) box.set(new THREE.Vector3(-0.1, -0.1, -0.1), new THREE.Vector3(0.1, 0.1, 0.1));
      const sphere = box.getBoundingSphere(new THREE.Sphere());
      this.box = box;
      this.middle = sphere.center, this.radius = Math.max(1e-4, sphere.radius);
      this.toolRadius = toolBox.isEmpty() ? 0 : toolBox.getBoundingSphere(new THREE.Sphere()).radius;
      this.camera.near = this.radius / 200, this.camera.far = this.radius * 60;
      this.trail = [];
      this.tool.visible = this.ghost.visible = false;  // until its pose comes
      this.makeArrows(), this.makeGrid(), this.recolor(), this.look('home');
    }

    makeGrid() {
      this.helpers.remove(...this.helpers.children);
      const steps = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1];
      this.gridStep = steps.find(s => s >= this.radius / 8) || 1;
      const cells = 2 * Math.ceil(1.6 * this.radius / this.gridStep);
      const grid = new THREE.GridHelper(cells * this.gridStep, cells);
      grid.material = new THREE.LineBasicMaterial();
      grid.rotation.x = Math.PI / 2;
      grid.position.set(this.middle.x, this.middle.y, this.box.min.z - 0.004 * this.radius);
      this.grid = grid;
      this.helpers.add(grid);
    }

    recolor() {
      const scene = color('--scene'), tool = color('--tool');
      this.statics.traverse(o => {
        if (!o.isMesh) return;
        o.material.color.copy(scene);
        o.material.opacity = this.seeThrough ? (o.material.side === THREE.BackSide ? 0.5 : 0.32) : 1;
        o.material.depthWrite = !this.seeThrough;
      });
      this.tool.traverse(o => { if (o.isMesh) o.material.color.copy(tool); });
      this.ghost.traverse(o => { if (o.isMesh) o.material.color.copy(color('--ghost')); });
      for (const kind of ['returned', 'contact']) this.arrows[kind].userData.material.color.copy(color('--' + kind));
      this.trailLine.material.color.copy(color('--trail'));
      this.dots.material.color.copy(color('--points'));
      if (this.shell) this.shell.material.color.copy(color('--shell'));
      for (const o of [this.cursor, this.pull]) o.material.color.copy(color('--cursor'));
      if (this.grid) {
        this.grid.geometry.deleteAttribute && this.grid.geometry.deleteAttribute('color');
        this.grid.material.color.copy(color('--grid'));
      }
      this.dirty = true;
    }

    rangeAlong(axis) {
      const margin = 0.1 * this.radius;
      return [this.box.min[axis] - margin, this.box.max[axis] + margin];
    }

    // Cells as a picture on a plane across one axis; what is free is not drawn.
    setSlice(slice) {
      if (this.slice) {
        this.world.remove(this.slice);
        this.slice.geometry.dispose(), this.slice.material.map.dispose(), this.slice.material.dispose();
        this.slice = null;
      }
      this.dirty = true;
      if (!slice) return;
      const {columns, rows, cells, step, at, axis} = slice, pixels = new Uint8Array(4 * columns * rows);
      const paint = [null, color('--surface'), color('--interior')];
      for (let n = 0; n < columns * rows; ++n) {
        const kind = paint[cells.charCodeAt(n) - 48];
        if (kind) pixels.set([255 * kind.r, 255 * kind.g, 255 * kind.b, 255], 4 * n);
      }
      const texture = new THREE.DataTexture(pixels, columns, rows, THREE.RGBAFormat);
      texture.magFilter = texture.minFilter = THREE.NearestFilter;
      texture.needsUpdate = true;
      const place = {x: (u, v) => [at, u, v], y: (u, v) => [u, at, v], z: (u, v) => [u, v, at]}[axis];
      const [u0, v0] = slice.low, u1 = u0 + columns * step, v1 = v0 + rows * step, geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array([place(u0, v0), place(u1, v0), place(u1, v1), place(u0, v1)].flat()), 3));
      geometry.setAttribute('uv', new THREE.BufferAttribute(new Float32Array([0, 0, 1, 0, 1, 1, 0, 1]), 2));
      geometry.setIndex([0, 1, 2, 0, 2, 3]);
      this.slice = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({map: texture, side: THREE.DoubleSide, transparent: true, opacity: 0.85, alphaTest: 0.3}));
      this.slice.renderOrder = 3;
      this.world.add(this.slice);
    }

    // The tool's pointshell: [x, y, z, ...] in its own frame, or null.
    setShell(points) {
      if (this.shell) {
        this.tool.remove(this.shell);
        this.shell.geometry.dispose(), this.shell.material.dispose();
        this.shell = null;
      }
      this.dirty = true;
      if (!points) return;
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(points), 3));
      this.shell = new THREE.Points(geometry, new THREE.PointsMaterial({size: 2, sizeAttenuation: false, depthTest: false, transparent: true, color: color('--shell')}));
      this.shell.renderOrder = 8;  // under the points in contact
      this.tool.add(this.shell);
    }

    toggleThrough() {
      this.seeThrough = !this.seeThrough;
      this.recolor();
      return this.seeThrough;
    }

    look(where) {
      const from = {home: [-0.75, -1.0, 0.62], front: [0, -1, 0.02], side: [1, 0, 0.02], top: [0, -0.001, 1], near: [-0.75, -1.0, 0.62]}[where];
      this.follow = where === 'near';
      const target = this.follow && this.tool.visible ? this.tool.position : this.middle.clone();
      let reach = this.follow ? Math.max(3.5 * this.toolRadius, 0.3 * this.radius) : 1.02 * this.radius;
      if (where === 'home' && this.tool.visible) {  // scene and tool, below the numbers
        const off = this.tool.position.clone().sub(this.middle), more = 0.6 * Math.min(this.radius, Math.max(0, off.length() + 2 * this.toolRadius - reach));
        target.addScaledVector(off.normalize(), more), reach += more;
      }
      const distance = reach / Math.sin(this.camera.fov * Math.PI / 360);
      this.controls.target.copy(target);
      this.camera.position.copy(target).addScaledVector(new THREE.Vector3(...from).normalize(), distance);
      this.controls.update();
      this.dirty = true;
    }

    setFrame(f) {
      const pose = (group, p) => {
        if (!p) return;
        const before = group.position.clone();
        group.position.set(p[0], p[1], p[2]), group.quaternion.set(p[3], p[4], p[5], p[6]), group.visible = true;
        return before;
      };
      pose(this.ghost, f.tool);
      const isFirst = f.object && !this.tool.visible, before = pose(this.tool, f.object);
      if (isFirst) this.look('home');
      if (f.tool && f.object) this.ghost.visible = f.tool.some((x, n) => Math.abs(x - f.object[n]) > (n < 3 ? 1e-5 : 1e-4));
      if (this.follow && before) {
        const moved = this.tool.position.clone().sub(before);
        this.camera.position.add(moved), this.controls.target.add(moved);
      }
      for (const [object, moved] of Object.entries(f.moved || {})) {
        const group = this.objects.get(Number(object));
        if (group) group.position.set(...moved);
      }
      this.setForces(f), this.setTrail(f), this.setPoints(f.points || []), this.setPull();
      this.dirty = true;
    }

    // Lengths of arrows: a round number of millimetres for a newton, such that the largest force of late is well seen and stays in the picture.
    setForces(f) {
      const returned = new THREE.Vector3(...(f.force || [0, 0, 0])), contact = new THREE.Vector3(...(f.contact_force || [0, 0, 0]));
      this.largest.push({t: f.t, n: Math.max(returned.length(), contact.length())});
      while (this.largest.length && (this.largest[0].t < f.t - 10 || this.largest[0].t > f.t)) this.largest.shift();
      const largest = Math.max(1e-3, ...this.largest.map(l => l.n)), most = 1.2 * this.radius;
      const exponent = Math.floor(Math.log10(most / largest)), lead = most / largest / 10 ** exponent;
      this.metresPerNewton = (lead >= 5 ? 5 : lead >= 2 ? 2 : 1) * 10 ** exponent;
      const from = {returned: this.ghost.position, contact: this.tool.position};
      for (const [kind, force] of [['returned', returned], ['contact', contact]]) {
        this.arrows[kind].userData.set(from[kind], force.clone().multiplyScalar(this.metresPerNewton), 0.16 * this.radius);
        this.labels[kind].textContent = `${sized(force.length(), 2)} N`;
        this.labels[kind].hidden = force.length() < 0.005;
        this.labels[kind].from = from[kind].clone();
        this.labels[kind].tip = from[kind].clone().addScaledVector(force, this.metresPerNewton);
      }
    }

    setTrail(f) {
      if (!f.object) return;
      const last = this.trail[this.trail.length - 1];
      if (last && f.t < last.t) this.trail = [];
      if (!last || f.t >= last.t + TRAIL_S / MOST_TRAIL) this.trail.push({t: f.t, p: f.object.slice(0, 3)});
      while (this.trail.length && (this.trail[0].t < f.t - TRAIL_S || this.trail.length > MOST_TRAIL)) this.trail.shift();
      const at = this.trailLine.geometry.getAttribute('position');
      this.trail.forEach((point, n) => at.setXYZ(n, ...point.p));
      at.needsUpdate = true;
      this.trailLine.geometry.setDrawRange(0, this.trail.length);
    }

    setPoints(points) {
      const at = this.dots.geometry.getAttribute('position'), count = Math.min(MOST_POINTS, points.length / 3);
      at.array.set(points.slice(0, 3 * count));
      at.needsUpdate = true;
      this.dots.geometry.setDrawRange(0, count);
    }

    // Where the hand wants the tool to be, and a line from there to the tool; null: nowhere.
    setCursor(position) {
      const same = position ? this.cursor.visible && this.cursor.position.equals(position) : !this.cursor.visible;
      if (same) return;
      this.cursor.visible = this.pull.visible = position !== null;
      if (position) this.cursor.position.copy(position), this.cursor.scale.setScalar(0.035 * this.radius);
      this.setPull();
    }
    setPull() {
      this.dirty = true;
      if (!this.pull.visible) return;
      const at = this.pull.geometry.getAttribute('position');
      at.setXYZ(0, ...this.tool.position.toArray()), at.setXYZ(1, ...this.cursor.position.toArray());
      at.needsUpdate = true;
    }

    /** Without a force in the last ten seconds the arrows have no scale. */
    scaleText() {
      const millimetres = metres => `${+(1000 * metres).toPrecision(3)} mm`;
      const arrow = this.largest.some(l => l.n >= 0.005) ? `1 N = ${millimetres(this.metresPerNewton)} of arrow · ` : '';
      return `${arrow}grid ${millimetres(this.gridStep || 0)}`;
    }

    placeLabels(width, height) {
      let taken = null;
      for (const kind of ['returned', 'contact']) {
        const label = this.labels[kind];
        if (label.hidden || !label.tip) continue;
        // Beyond the tip, in the arrow's direction: nothing of the arrow is covered.
        const on = v => { const p = v.clone().project(this.camera); return {x: (p.x + 1) / 2 * width, y: (1 - p.y) / 2 * height}; };
        const tip = on(label.tip), from = on(label.from), along = Math.hypot(tip.x - from.x, tip.y - from.y) || 1;
        let x = tip.x + 44 * (tip.x - from.x) / along - 28, y = tip.y + 24 * (tip.y - from.y) / along - 11;
        x = Math.min(Math.max(x, 6), width - 70), y = Math.min(Math.max(y, 118), height - (document.body.classList.contains('bag') ? 110 : 64));
        if (taken && Math.abs(taken.x - x) < 66 && Math.abs(taken.y - y) < 23) y = y < taken.y ? taken.y - 24 : taken.y + 24;
        label.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
        taken = {x, y};
      }
    }

    draw() {
      const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
      if (width === 0 || height === 0) return false;
      if (width !== this.width || height !== this.height) {
        this.width = width, this.height = height, this.dirty = true;
        this.renderer.setPixelRatio(Math.min(this.mostPixels, window.devicePixelRatio));
        this.renderer.setSize(width, height, false);
        this.camera.aspect = width / height;
        this.camera.setViewOffset(width, height, 0, -0.02 * height, width, height);  // numbers stand above, words below
        this.camera.updateProjectionMatrix();
      }
      if (!this.dirty) return false;
      this.dirty = false;
      this.light.position.copy(this.camera.position).addScaledVector(new THREE.Vector3(0.3, 0.2, 1), this.radius * 2);
      this.placeLabels(width, height);
      this.renderer.render(this.world, this.camera);
      return true;
    }
  }
  window.Scene3D = Scene3D;
})();
