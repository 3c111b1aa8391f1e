// The parser includes this file, but uses none of its content.
#pragma once
