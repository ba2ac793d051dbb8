#include "report.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "gotai/core/error.h"
#include "gotai/view/pack.h"
#include "gotai/view/page.h"
#include "svg.h"

namespace gotai::experiments {
namespace {

constexpr const char* kStyle = R"css(
:root { color-scheme: light dark; --ink: #1b1f24; --paper: #fff; --soft: #f3f5f7; --line: #d9dee4; --good: #1a7f46; --bad: #c2313b; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e9ec; --paper: #14181c; --soft: #1d2329; --line: #333b44; --good: #4cc27f; --bad: #ff7a80; } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper); max-width: 72rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.7rem; } h2 { margin-top: 3rem; border-top: 1px solid var(--line); padding-top: 1.5rem; }
.thesis { color: #7a8794; font-weight: normal; font-size: .8em; }
.plots { display: flex; flex-wrap: wrap; gap: 1rem; }
figure { margin: 0; } .animation { margin: 1rem 0; } figure img { max-width: 100%; border-radius: 6px; display: block; }
iframe { width: 100%; height: 34rem; border: 1px solid var(--line); border-radius: 6px; }
button { font: inherit; padding: .2rem .9rem; margin: .3rem 0; }
figcaption { font-size: .9rem; } figure svg { max-width: 100%; height: auto; border-radius: 6px; }
table { border-collapse: collapse; margin: 1rem 0; font-size: .9rem; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .7rem; border-bottom: 1px solid var(--line); text-align: left; }
th { background: var(--soft); }
caption { text-align: left; font-weight: 600; padding: .3rem 0; }
.pass { color: var(--good); } .fail { color: var(--bad); font-weight: 600; }
footer { margin-top: 3rem; color: #7a8794; font-size: .85rem; }
)css";

// Fills a run into the viewer's page, where viewer/index.html says what it shows.
constexpr const char* kPlayer = R"js(
const page = new TextDecoder().decode(Uint8Array.from(atob(document.getElementById('viewer').textContent), c => c.charCodeAt(0)));
for (const button of document.querySelectorAll('.animation button'))
  button.addEventListener('click', () => {
    const frame = document.createElement('iframe');
    const run = button.nextElementSibling.textContent;
    frame.srcdoc = page.replace('data-source="file">@GOTAI_RUN@', () => 'data-source="file">' + run);
    button.replaceWith(frame);
  });
)js";

std::string table_html(const Table& table) {
  std::string html = "<table><caption>";
  if (!table.number.empty()) html += escape_xml(table.number) + ": ";
  html += escape_xml(table.title) + "</caption>\n";
  for (std::size_t k = 0; k < table.rows.size(); ++k) {
    const char* cell = k == 0 ? "th" : "td";
    html += "<tr>";
    for (const std::string& text : table.rows[k])
      html += fmt::format("<{0}>{1}</{0}>", cell, escape_xml(text));
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

std::string verdicts_html(const std::vector<Verdict>& verdicts) {
  std::string html =
      "<table><caption>What was expected, what came out</caption>\n"
      "<tr><th></th><th>quantity</th><th>expected</th><th>found</th></tr>\n";
  for (const Verdict& v : verdicts)
    html += fmt::format(R"(<tr><td class="{}">{}</td><td>{}</td><td>{}</td><td>{}</td></tr>)"
                        "\n",
                        v.passed ? "pass" : "fail", v.passed ? "passed" : "FAILED",
                        escape_xml(v.what), escape_xml(v.expected), escape_xml(v.found));
  return html + "</table>\n";
}

std::string caption(const std::string& figure, const std::string& title) {
  return "<figcaption>" + escape_xml(figure.empty() ? title : figure + ": " + title) +
         "</figcaption>";
}

std::string image(const std::string& png, const std::string& title) {
  return fmt::format(R"(<img alt="{}" src="data:image/png;base64,{}">)", escape_xml(title), png);
}

std::string animation_html(const Animation& animation) {
  std::string html = "<figure class=\"animation\">" + image(animation.strip, animation.title) +
                     caption(animation.figure, animation.title);
  if (!animation.run.empty())
    html += "<button type=\"button\">Play</button><script type=\"text/plain\">" + animation.run +
            "</script>";
  return html + "</figure>\n";
}

/// The viewer, once for all animations, and what opens it.
std::string player_html(const std::vector<Result>& results) {
  bool plays = false;
  for (const Result& result : results)
    for (const Animation& animation : result.outcome.animations)
      plays = plays || !animation.run.empty();
  if (!plays) return "";
  const std::string_view page = view::page_template();
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(page.data());
  return "<script type=\"text/plain\" id=\"viewer\">" +
         view::to_base64(std::span(bytes, page.size())) + "</script>\n<script>" + kPlayer +
         "</script>\n";
}

std::string section_html(const Result& result) {
  const Experiment& experiment = *result.experiment;
  std::string html = fmt::format(
      "<section id=\"{}\"><h2>{} <span class=\"thesis\">{} · gotai experiment "
      "{}</span></h2>\n<p>{}</p>\n",
      escape_xml(experiment.id), escape_xml(experiment.title), escape_xml(experiment.thesis),
      escape_xml(experiment.id), escape_xml(experiment.about));
  html += "<div class=\"plots\">\n";
  for (const Plot& plot : result.outcome.plots) html += "<figure>" + plot_svg(plot) + "</figure>\n";
  for (const Picture& picture : result.outcome.pictures)
    html += "<figure>" + (picture.png.empty() ? picture.svg : image(picture.png, picture.title)) +
            caption(picture.figure, picture.title) + "</figure>\n";
  html += "</div>\n";
  for (const Animation& animation : result.outcome.animations) html += animation_html(animation);
  for (const Table& table : result.outcome.tables) html += table_html(table);
  if (!result.outcome.verdicts.empty()) html += verdicts_html(result.outcome.verdicts);
  return html + "</section>\n";
}

std::string summary_html(const std::vector<Result>& results) {
  std::string html =
      "<table><tr><th>experiment</th><th>thesis</th><th>verdict</th><th>points</th></tr>\n";
  for (const Result& result : results) {
    std::size_t passed = 0;
    for (const Verdict& v : result.outcome.verdicts) passed += v.passed ? 1 : 0;
    html += fmt::format(
        R"(<tr><td><a href="#{0}">{0}</a></td><td>{1}</td><td class="{2}">{3} of {4} as expected</td><td>{5}</td></tr>)"
        "\n",
        escape_xml(result.experiment->id), escape_xml(result.experiment->thesis),
        result.passed() ? "pass" : "fail", passed, result.outcome.verdicts.size(),
        result.records.size());
  }
  return html + "</table>\n";
}

}  // namespace

std::string report_html(const std::vector<Result>& results) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>Gotai: experiments</title>\n<style>";
  html += kStyle;
  html += "</style></head><body>\n";
  html += results.size() == 1 ? "<h1>Gotai: " + escape_xml(results[0].experiment->title) + "</h1>\n"
                              : "<h1>Gotai: the thesis's figures and tables</h1>\n";
  html += summary_html(results);
  for (const Result& result : results) html += section_html(result);
  html += player_html(results);
  if (!results.empty()) {
    html += "<footer>";
    for (const auto& [key, value] : results[0].provenance.items())
      html += escape_xml(key) + ": " +
              escape_xml(value.is_string() ? value.get<std::string>() : value.dump()) + " · ";
    html += "</footer>\n";
  }
  return html + "</body></html>\n";
}

void write_text(const std::string& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  out.flush();
  if (!out)
    throw FileError(path, "cannot be written; is the folder there, writable, the disk full?");
}

void write_results(const Result& result, const std::string& folder) {
  std::filesystem::create_directories(folder);
  write_text(folder + "/results.json", to_json(result).dump(2) + "\n");
  write_text(folder + "/results.csv", to_csv(result));
  write_text(folder + "/report.html", report_html({result}));
  for (std::size_t k = 0; k < result.outcome.plots.size(); ++k)
    write_text(fmt::format("{}/plot-{}.svg", folder, k + 1), plot_svg(result.outcome.plots[k]));
  for (std::size_t k = 0; k < result.outcome.pictures.size(); ++k)
    if (!result.outcome.pictures[k].svg.empty())
      write_text(fmt::format("{}/picture-{}.svg", folder, k + 1), result.outcome.pictures[k].svg);
}

}  // namespace gotai::experiments
