// Where tests look for it; the class itself is used by tools/hil_runner as well.
#pragma once

#include "shared/host/pty_bridge.h"
