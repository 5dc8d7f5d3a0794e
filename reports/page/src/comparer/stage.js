// The picture itself: one transform for all views, so that they stay in step while one zooms, pans and switches.

/** state: {zoom, x, y}: the pixel in the middle, and how many times the image is larger than what fits. */
export class Stage {
  constructor(canvas) {
    this.canvas = canvas;
    this.size = { width: 1, height: 1 };
    this.zoom = 1;
    this.x = 0.5;
    this.y = 0.5;
  }

  /** The image's size in pixels; the canvas takes its shape. */
  fit(width, height) {
    this.size = { width, height };
    this.canvas.style.aspectRatio = `${width} / ${height}`;
    this.reset();
  }

  reset() {
    this.zoom = 1;
    this.x = this.size.width / 2;
    this.y = this.size.height / 2;
  }

  /** Canvas pixels of the screen; called before drawing. */
  resize() {
    const box = this.canvas.getBoundingClientRect();
    const density = Math.min(2, window.devicePixelRatio || 1);
    const width = Math.max(1, Math.round((box.width || 256) * density));
    const height = Math.max(1, Math.round((width * this.size.height) / this.size.width));
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
  }

  get scale() {
    return (this.canvas.width / this.size.width) * this.zoom;
  }

  /** Moves the middle, as far as the image fills the canvas. */
  pan(dx, dy) {
    const half = { x: this.size.width / this.zoom / 2, y: this.size.height / this.zoom / 2 };
    this.x = Math.max(half.x, Math.min(this.size.width - half.x, this.x + dx));
    this.y = Math.max(half.y, Math.min(this.size.height - half.y, this.y + dy));
  }

  /** Zooms about a pixel that stays where it is; without one about the middle. */
  zoomBy(factor, about = null) {
    const before = this.zoom;
    this.zoom = Math.max(1, Math.min(64, this.zoom * factor));
    const keep = about ?? { x: this.x, y: this.y };
    this.x = keep.x + ((this.x - keep.x) * before) / this.zoom;
    this.y = keep.y + ((this.y - keep.y) * before) / this.zoom;
    this.pan(0, 0);
  }

  /** Image coordinates of a place in the window. */
  toImage(clientX, clientY) {
    const box = this.canvas.getBoundingClientRect();
    const s = this.scale;
    return {
      x: ((clientX - box.left) / box.width - 0.5) * (this.canvas.width / s) + this.x,
      y: ((clientY - box.top) / box.height - 0.5) * (this.canvas.height / s) + this.y,
    };
  }

  /** layers: [{bitmap, from, to}] parts of the canvas' width as shares; cursor: a pixel or null. */
  draw(layers, cursor, line) {
    this.resize();
    const context = this.canvas.getContext("2d");
    const { width, height } = this.canvas;
    const s = this.scale;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, width, height);
    context.imageSmoothingEnabled = s < 1;
    const left = width / 2 - this.x * s;
    const top = height / 2 - this.y * s;
    for (const { bitmap, from, to } of layers) {
      context.save();
      context.beginPath();
      context.rect(from * width, 0, (to - from) * width, height);
      context.clip();
      context.drawImage(bitmap, left, top, this.size.width * s, this.size.height * s);
      context.restore();
    }
    if (line !== null)
      stroke(context, () => {
        context.moveTo(line * width, 0);
        context.lineTo(line * width, height);
      });
    if (cursor)
      stroke(context, () =>
        context.rect(left + cursor.x * s - 1, top + cursor.y * s - 1, Math.max(5, s + 2), Math.max(5, s + 2)),
      );
  }
}

/** Black on white, so that it is seen on any picture. */
function stroke(context, path) {
  for (const [colour, width] of [
    ["#fff", 4],
    ["#000", 1.5],
  ]) {
    context.beginPath();
    path();
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.stroke();
  }
}
