#include "core/types/motion.hpp"
namespace voxtouch {
}  // namespace voxtouch
