// Where the workstation looks for it; tools/hil_runner draws with it as well.
#pragma once

#include "shared/host/gnuplot.h"
