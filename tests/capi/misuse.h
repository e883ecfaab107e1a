/* The two halves of the test of misuse. */
#ifndef ETENDUE_TESTS_MISUSE_H
#define ETENDUE_TESTS_MISUSE_H

#include "check.h"

/* What goes wrong over time: states, orders, threads, callbacks. `quick`: with few repetitions. */
void misuse_life(int quick);

#endif
