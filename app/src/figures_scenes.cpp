// SPDX-License-Identifier: GPL-3.0-or-later
// Figures of whole scenes, compared with path tracing at equal time.
#include "figure_parts.h"

namespace vrc {
namespace {

/// The paper's options; small pictures take few rays and an order that is quick.
std::string paper_words(FigureSize size, int records, int gather_rays) {
  return size == FigureSize::kFull
             ? "--preset paper " + records_words(records, gather_rays)
             : std::string("--preset paper --sh-order 10 --gather-rays 1024 --error 0.2");
}

/// A picture by the paper's records, and by path tracing in the same time.
FigureGroup equal_time_group(const std::string& name, const std::string& scene, const std::string& words,
                             const std::string& prefix, const std::string& cache, const NamedNumbers& paper,
                             FigureSize size) {
  FigureGroup group{name, scene, words};
  group.panels = {
      reference_panel(prefix + "reference", size),
      {prefix + "cache", "The paper's records", cache, prefix + "reference", paper},
      {prefix + "path",
       "Path tracing",
       "--method path",
       prefix + "reference",
       {},
       EqualTime{prefix + "cache", "--spp", 160}},
  };
  return group;
}

FigureMeasure equal_time_measure(const std::string& name, const std::string& prefix,
                                 std::optional<FigureBound> bound) {
  return ratio_measure(name + ": relMSE, path tracing over records", prefix + "path", prefix + "cache",
                       "relmse", bound);
}

constexpr const char* kKitchen = "kitchen.xml";
constexpr int kKitchenRecords = 90000, kKitchenRays = 14400;

}  // namespace

Figure figure_9(FigureSize size) {
  Figure figure;
  figure.title = "GGX surfaces";
  figure.claim =
      "Records follow the sharper reflections of GGX; in the box path tracing has larger errors at equal "
      "time.";
  const int side = pick(size, 160, 512), count = pick(size, 1000, 5000);
  FigureGroup kitchen =
      equal_time_group("kitchen, GGX", kKitchen,
                       indirect_words(pick(size, 96, 1024), pick(size, 72, 768)) + " -D material=ggx",
                       "kitchen_", paper_words(size, kKitchenRecords, kKitchenRays), {}, size);
  FigureGroup box =
      equal_time_group("cornell_ggx", "cornell_ggx.xml", indirect_words(side, side) + " --exposure 1.5",
                       "box_", "--preset paper " + records_words(count, 8192), {}, size);
  box.panels.push_back({"box_ours", "This program's defaults", records_words(count, 8192), "box_reference"});
  box.curves = {
      {"box_curve",
       "GGX box, 8192 rays a record",
       {records_series("box_cache", count), samples_series("box_path"), records_series("box_ours", count)},
       {"cpu_seconds", "rays"}}};
  figure.groups = {kitchen, box};
  figure.measures = {
      equal_time_measure("kitchen", "kitchen_", {}),
      equal_time_measure("box", "box_", at_least(5.0)),
      ratio_measure("box: relMSE, records over defaults", "box_cache", "box_ours", "relmse", {}),
  };
  return figure;
}

Figure figure_10(FigureSize size) {
  Figure figure;
  figure.title = "A kitchen of highly glossy surfaces";
  figure.claim =
      "In close-ups, records by the radiance towards the camera have lower errors than view-independent "
      "spherical harmonics of the same number, which cannot hold reflections of exponents up to 400.";
  FigureGroup kitchen{"kitchen", kKitchen, indirect_words(pick(size, 96, 1024), pick(size, 72, 768))};
  kitchen.panels = {reference_panel("kitchen_reference", size),
                    {"kitchen",
                     "The paper's records",
                     paper_words(size, kKitchenRecords, kKitchenRays),
                     "kitchen_reference",
                     {{"records", 90000}, {"gather_rays", 14400}, {"seconds", 6000}}}};
  figure.groups = {kitchen};
  figure.measures = {panel_measure("kitchen: relMSE", "kitchen", "relmse", {})};
  const std::string records = records_words(1600, pick(size, 2048, kKitchenRays));
  struct CloseUp {
    const char* name;
    const char* words;
  };
  for (const CloseUp& view :
       {CloseUp{"pots", ""},
        CloseUp{"worktop", " -D camera=1.7,1.45,1.6 -D target=1.05,0.9,0.3 -D fov=30"}}) {
    const std::string prefix = std::string(view.name) + "_";
    FigureGroup group{std::string("close-up: ") + view.name, "kitchen_pots.xml",
                      indirect_words(pick(size, 80, 512), pick(size, 60, 384)) + view.words};
    group.panels = {
        reference_panel(prefix + "reference", size),
        {prefix + "view_dependent",
         "View-dependent",
         "--preset paper --sh-order 10 " + records,
         prefix + "reference",
         {{"records", 1600}}},
        {prefix + "harmonics",
         "View-independent, spherical harmonics",
         "--preset paper --representation sh --sh-order 10 --strategy view-independent " + records,
         prefix + "reference",
         {{"records", 1600}}},
    };
    figure.groups.push_back(group);
    const std::string name = view.name;
    figure.measures.push_back(ratio_measure(name + ": median error, harmonics over view-dependent",
                                            prefix + "harmonics", prefix + "view_dependent", "median_error",
                                            at_least(1.1)));
    // A few records of exponents up to 400 that missed the light decide this one.
    figure.measures.push_back(ratio_measure(name + ": relMSE, harmonics over view-dependent",
                                            prefix + "harmonics", prefix + "view_dependent", "relmse", {}));
  }
  return figure;
}

Figure figure_12(FigureSize size) {
  Figure figure;
  figure.title = "A crown on a plate of exponent 1000";
  figure.claim =
      "On the plate, which reflects the crown sharply and brightly, the cache has a lower error than path "
      "tracing in the same time.";
  FigureGroup crown =
      equal_time_group("crown", "crown.xml", indirect_words(pick(size, 112, 1280), pick(size, 67, 768)),
                       "crown_", paper_words(size, 100000, 32768),
                       {{"records", 100000}, {"gather_rays", 32768}, {"seconds", 9468}}, size);
  // Its time goes into the crown's small parts; at the quick size paths would take all of the figure's.
  if (size == FigureSize::kQuick)
    crown.panels.pop_back();
  else
    crown.panels.back().paper = {{"seconds", 108000}};  // of the paper's reference
  const int count = pick(size, 700, 20000);
  FigureGroup plate =
      equal_time_group("reflection on the plate", "crown.xml",
                       indirect_words(pick(size, 128, 1280), pick(size, 64, 640)) +
                           " --exposure 1 -D target=-0.6,0,2.35 -D fov=14",
                       "plate_", "--preset paper " + records_words(count, pick(size, 8192, 32768)), {}, size);
  // The noise of fewer rays is so skewed at this exponent that two of its halves hide an error of 3e-3.
  plate.panels.front() = reference_panel("plate_reference", pick(size, 32, 64), pick(size, 2048, 4096));
  plate.panels.push_back({"plate_ours", "This program's defaults",
                          std::string("--error-of records --error ") + pick(size, "0.07", "0.03"),
                          "plate_reference"});
  plate.curves = {{"plate_curve",
                   "Reflection on the plate",
                   {records_series("plate_cache", count), samples_series("plate_path")},
                   {"cpu_seconds", "rays"}}};
  figure.groups = {crown, plate};
  figure.measures = {
      equal_time_measure("plate", "plate_", at_least(1.2)),
      ratio_measure("plate: relMSE, path tracing over defaults", "plate_path", "plate_ours", "relmse",
                    at_least(2.0)),
      ratio_measure("plate: CPU time, path tracing over defaults", "plate_path", "plate_ours", "cpu_seconds",
                    {}),
      panel_measure("crown: relMSE", "crown_cache", "relmse", {}),
  };
  if (size == FigureSize::kFull) figure.measures.push_back(equal_time_measure("crown", "crown_", {}));
  return figure;
}

}  // namespace vrc
