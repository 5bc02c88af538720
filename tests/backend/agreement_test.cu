#include "backend/agreement_suite.hpp"
