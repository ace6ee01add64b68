#pragma once
/// How two that play one role know of each other, by their statuses: who acts names its standby,
/// and everybody follows these two.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/standby_options.hpp"

namespace voxtouch::runtime {

/// Words of a status. Only of nodes that have a standby, or are one.
inline constexpr char kDuty[] = "duty", kActs[] = "acts", kStandsBy[] = "stands by";
inline constexpr char kStandby[] = "standby", kNoStandby[] = "none";

/// As the one or the other of the two.
bool plays(const NodeReport& report, std::string_view role);
/// Starting, ready or running, in a session.
bool takes_part(const NodeReport& report);
/// Whether it says that it acts: a standby once it has taken over, any other as long as it does not
/// say that it stands by.
bool says_that_it_acts(const NodeReport& report, std::string_view role);

/// And one that has a standby, or was one: a rival that knows of none is not meant.
bool says_that_it_acts_in_a_pair(const NodeReport& report, std::string_view role);

/// 32 hexadecimal digits.
std::string to_hex(const bus::Guid& guid);
/// What an acting one says of its standby. `says`: it says something; without a participant: that
/// it has none.
struct NamedStandby {
  bool says = false;
  std::optional<bus::Guid> participant;
};
/// Says nothing where the report has no such word, or one that is no GUID.
NamedStandby named_standby(const NodeReport& report);

/// What must be equal in two statuses for one to take the other's place: words and figures, by
/// name.
struct SameIn {
  std::vector<std::string> words, figures;
  /// The first name that is not equal; empty: all are.
  std::string difference(const NodeReport& a, const NodeReport& b) const;
};

/// The other participant that acts in `role`; none where there is none, or more than one.
std::optional<bus::Guid> who_acts(const std::vector<NodeReport>& reports, std::string_view role,
                                  const bus::Guid& own);
/// Those that an acting one might take: they play its role, do not act, are ready for its session,
/// and are equal in `same`.
std::vector<bus::Guid> who_could_stand_by(const std::vector<NodeReport>& reports,
                                          std::string_view role, const NodeReport& own_report,
                                          const bus::Guid& own, const SameIn& same);

}  // namespace voxtouch::runtime
