#include "adaptation/switching_books_suite.hpp"
