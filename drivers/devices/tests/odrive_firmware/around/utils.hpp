// Included by the parser, which uses nothing of it.
#pragma once
