/// No test finds what another one built, and none writes into the user's cache: what tests this
/// cache says so itself.
#include <cstdlib>

namespace {
[[maybe_unused]] const int kSet = ::setenv("VOXTOUCH_NO_CACHE", "1", 0);
}
