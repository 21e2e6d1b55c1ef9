// The control loop as bess-edge instantiates it, in an object of its own for the object proofs.
#include "edge/control_loop.h"
#include "edge/edge_clock.h"
#include "edge/modbus_battery.h"
#include "edge/price_feed.h"

template class bess::ControlLoop<bess::ModbusBattery, bess::PriceFeed, bess::EdgeClock>;
