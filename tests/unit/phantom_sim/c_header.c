/* That hdsim.h is C: an enumerator and a size, as a C compiler sees them. */
#include "devices/phantom/simulated/hdsim.h"

int hdsim_header_is_c(void) { return HDSIM_COMM_ERROR == 1 ? (int)sizeof(hdsim_state) : 0; }
