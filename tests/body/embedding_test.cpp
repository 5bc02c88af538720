#include "body/embedding_suite.hpp"
