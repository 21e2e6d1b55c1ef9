// Control loop as bess-edge instantiates it, in an object for the object proofs.
#include "edge/app/program/controller.h"
#include "edge/app/program/real_world.h"

template class bess::ControlLoop<bess::ModbusBattery, bess::RealWorld::Prices, bess::EdgeClock,
                                 bess::Controller<bess::RealWorld>::Site>;
