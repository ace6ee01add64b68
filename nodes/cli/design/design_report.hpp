#pragma once
/// A designed coupling as text and JSON (which voxtouch_plot draws), and its stable region as CSV.
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/coupling/design/absolute_stability.hpp"
#include "core/coupling/design/designer.hpp"
#include "core/coupling/design/stable_region.hpp"
#include "core/device_fit/force_preview.hpp"

namespace voxtouch::cli {

/// How the paper's literal recipe (5 Hz, damping ratio 1, no margin) would do in the same loop.
struct PaperRecipe {
  double stiffness = 0.0;          ///< requested: the smaller of contact and device limit
  double critical_released = 0.0;  ///< with the device released; NaN if that case is excluded
  double critical_gripped = 0.0;   ///< worst of the hands
};
/// The 5 Hz filter of the paper (Renz et al. 2001) on the problem's device and hands, by the exact
/// loop.
PaperRecipe judge_paper_recipe(const coupling::design::DesignProblem& problem);
/// Stiffness at the hand over the filter's cut-off, from 1 Hz on: the stable region for the chosen
/// damping.
coupling::design::StableRegion region_round(const coupling::design::DesignProblem& problem,
                                            const coupling::design::Design& design);

/// Stiffness at the hand over the one number that a law without a cut-off has: injected damping of
/// `direct`, damper over spring of `spring_damper`.
struct LawRegion {
  std::string over, unit;        ///< empty: the shaping filter, with its region over the cut-off
  double chosen = 0.0;           ///< of `over`
  std::vector<double> x;         ///< of `over`, from a tenth of the chosen one to ten times it
  std::vector<double> critical;  ///< the worst case becomes unstable here [N/m]
};
/// Stiffness over the one number of the law that the design chose, by the exact loop of the
/// problem's worst case.
LawRegion region_of_law(const coupling::design::DesignProblem& problem,
                        const coupling::design::Design& design);

struct DesignReport {
  coupling::design::DesignProblem problem;
  coupling::design::Design design;
  coupling::design::ContactCertificate certificate;
  PaperRecipe paper;
  coupling::design::StableRegion region;            ///< of the chosen damping, over the cut-off
  LawRegion law;                                    ///< of the chosen law, if it is not a filter
  std::optional<device_fit::ForcePreview> preview;  ///< of a scene on the device
  std::string device, hand, contact;                ///< sources of the numbers
};

/// As text, and as JSON with null for non-finite values.
std::string to_text(const DesignReport& report);
nlohmann::ordered_json to_json(const DesignReport& report);
/// The region: RFC 4180 with a header, one row for each cut-off, columns as in the JSON; empty if
/// infinite: nothing makes the loop unstable.
std::string to_csv(const DesignReport& report);

}  // namespace voxtouch::cli
