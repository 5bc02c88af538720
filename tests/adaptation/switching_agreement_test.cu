#include "adaptation/switching_agreement_suite.hpp"
