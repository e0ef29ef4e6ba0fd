#pragma once

// TROUPE_ADDRESS_SANITIZER and TROUPE_THREAD_SANITIZER are defined in sources that are compiled with these
// sanitizers. gcc has macros for that, clang before 22 only features.
#if defined(__SANITIZE_ADDRESS__)
#define TROUPE_ADDRESS_SANITIZER
#elif defined(__SANITIZE_THREAD__)
#define TROUPE_THREAD_SANITIZER
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define TROUPE_ADDRESS_SANITIZER
#elif __has_feature(thread_sanitizer)
#define TROUPE_THREAD_SANITIZER
#endif
#endif
