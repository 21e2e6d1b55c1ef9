// The control loop as bess-edge instantiates it, in an object of its own for the object proofs.
#include "edge/battery/modbus_battery.h"
#include "edge/battery/modbus_meter.h"
#include "edge/control/control_loop.h"
#include "edge/prices/price_feed.h"
#include "edge/program/edge_clock.h"
#include "edge/program/limit_file.h"

template class bess::ControlLoop<bess::ModbusBattery, bess::PriceFeed, bess::EdgeClock,
                                 bess::SiteLimits<bess::ModbusMeter, bess::LimitFile>>;
