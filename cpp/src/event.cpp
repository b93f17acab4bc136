// Compiled once: what happens on the way.
#include "exported.hpp"

#include "rbdyn/event/abreast.ipp"
#include "rbdyn/event/driver.ipp"
#include "rbdyn/event/driver_ends.ipp"
#include "rbdyn/event/event.ipp"
#include "rbdyn/event/memory_watch.ipp"
#include "rbdyn/event/passages.ipp"
#include "rbdyn/event/progress.ipp"
#include "rbdyn/event/record.ipp"
#include "rbdyn/event/search.ipp"
#include "rbdyn/event/search_least.ipp"
