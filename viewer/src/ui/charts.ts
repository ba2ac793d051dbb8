/** Charts of the measurements, in step with the time bar. */

import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { locate } from "../data/interpolate";
import type { Run, SeriesHeader } from "../data/run";
import { format, formatTick, h } from "./dom";

const kColours = ["#3f7fe8", "#f0a030", "#38a87a", "#dd5a8a", "#8d6be0"];
const kHeight = 92; // pixels, before the charts are fitted to the page
const kLeastHeight = 46;
const kMostHeight = 120;

interface Chart {
  plot: uPlot;
  place: HTMLElement;
  marker: HTMLElement;
  values: { header: SeriesHeader; text: HTMLElement }[];
}

/** Few powers of ten, whatever the span. */
function decades(_: uPlot, ticks: number[]): (number | null)[] {
  const exponents = ticks.filter((t) => t > 0).map((t) => Math.log10(t));
  const span = exponents.length ? Math.max(...exponents) - Math.min(...exponents) : 0;
  const stride = Math.max(1, Math.ceil(span / 3));
  return ticks.map((t) => {
    const exponent = Math.round(Math.log10(t));
    return t > 0 && Math.abs(Math.log10(t) - exponent) < 1e-6 && exponent % stride === 0 ? t : null;
  });
}

/** Positive values a logarithmic axis can show; others leave a gap. */
const positive = (values: number[]) => values.map((v) => (v > 0 ? v : null));

export class Charts {
  readonly element = h("div", { class: "card charts" });
  private charts: Chart[] = [];
  private drawnPoints = -1;
  private height = kHeight;

  constructor(private readonly run: Run, private readonly seek: (time: number) => void) {
    this.build();
  }

  get empty(): boolean {
    return this.charts.length === 0;
  }

  /** Draws anew: after a change of colours, of the width, or of the data. */
  build(): void {
    for (const { plot } of this.charts) plot.destroy();
    this.element.replaceChildren();
    const groups = new Map<string, SeriesHeader[]>();
    for (const series of this.run.header.series)
      groups.set(series.chart, [...(groups.get(series.chart) ?? []), series]);
    this.charts = [...groups].map(([title, series]) => this.chart(title, series));
    this.drawnPoints = this.run.series.time.length;
    this.fit();
  }

  /** Gives the charts the height that the page has for them, so that all can be seen at once. */
  fit(): void {
    const column = this.element.parentElement;
    if (!column || !this.element.clientHeight || this.empty) return;
    const taken = [...column.children]
      .filter((child) => child !== this.element && (child as HTMLElement).offsetHeight)
      .reduce((sum, child) => sum + (child as HTMLElement).offsetHeight + 10, 0);
    const spare = column.clientHeight - taken - (this.element.scrollHeight + 2);
    const height = Math.floor(Math.min(kMostHeight, Math.max(kLeastHeight, this.height + spare / this.charts.length)));
    if (height === this.height) return;
    this.height = height;
    for (const { plot, place } of this.charts) {
      place.style.height = `${height}px`; // at once; the plot follows later
      plot.setSize({ width: plot.width, height });
    }
  }

  update(time: number): void {
    const { series } = this.run;
    if (series.time.length !== this.drawnPoints) {
      this.drawnPoints = series.time.length;
      this.charts.forEach(({ plot, values }) => plot.setData(this.data(values.map((v) => v.header))));
    }
    const { index, fraction } = locate(series.time, time);
    const nearest = Math.min(series.time.length - 1, fraction > 0.5 ? index + 1 : index);
    for (const { plot, marker, values } of this.charts) {
      const left = plot.valToPos(time, "x");
      const width = plot.bbox.width / devicePixelRatio;
      marker.hidden = !(left >= 0 && left <= width);
      marker.style.transform = `translateX(${left}px)`;
      for (const { header, text } of values)
        text.textContent = format(series.values.get(header.name)![nearest]);
    }
  }

  private data(series: SeriesHeader[]): uPlot.AlignedData {
    const log = series[0].chart === "Residual";
    const columns = series.map((s) => {
      const values = this.run.series.values.get(s.name)!;
      return log ? positive(values) : values;
    });
    return [this.run.series.time, ...columns] as uPlot.AlignedData;
  }

  private chart(title: string, series: SeriesHeader[]): Chart {
    const style = getComputedStyle(document.documentElement);
    const ink = style.getPropertyValue("--dim").trim();
    const grid = { stroke: style.getPropertyValue("--rule").trim(), width: 1 };
    const axis = { stroke: ink, grid, ticks: { show: false }, font: "10px system-ui, sans-serif" };
    const head = h("header", {}, h("h3", {}, `${title}${series[0].unit ? ` [${series[0].unit}]` : ""}`));
    const values = series.map((entry, i) => {
      const dot = h("i");
      dot.style.background = kColours[i % kColours.length];
      const text = h("b");
      head.append(h("span", { title: entry.label }, dot, `${entry.label} `, text));
      return { header: entry, text };
    });
    const place = h("div", { class: "plot" });
    place.style.height = `${this.height}px`;
    this.element.append(h("section", { "data-chart": title }, head, place));
    const log = title === "Residual";
    const plot = new uPlot(
      {
        width: this.element.clientWidth ? place.clientWidth : 316,
        height: this.height,
        legend: { show: false },
        cursor: { drag: { x: false, y: false }, points: { show: false }, y: false },
        padding: [6, 8, 0, 0],
        scales: { x: { time: false }, y: log ? { distr: 3 } : {} },
        axes: [
          { ...axis, size: 18, gap: 2, space: 50 },
          { ...axis, ...(log ? { filter: decades, grid: { ...grid, filter: decades } } : {}),
            size: 44, gap: 3, space: 24, values: (_, ticks) => ticks.map((t) => (t == null ? "" : formatTick(t))) },
        ],
        series: [
          {},
          ...series.map((_, i) => ({ stroke: kColours[i % kColours.length], width: 1.4, points: { show: false } })),
        ],
      },
      this.data(series),
      place,
    );
    const marker = h("div", { class: "marker" });
    plot.over.append(marker);
    const seekTo = (event: PointerEvent) => {
      const box = plot.over.getBoundingClientRect();
      this.seek(plot.posToVal(event.clientX - box.left, "x"));
    };
    plot.over.addEventListener("pointerdown", (event) => {
      plot.over.setPointerCapture(event.pointerId);
      seekTo(event);
    });
    plot.over.addEventListener("pointermove", (event) => {
      if (event.buttons & 1) seekTo(event);
    });
    return { plot, place, marker, values };
  }
}
