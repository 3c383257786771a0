// Included twice, with A, B and C that are specialization constants, and with some that the device reads: both compute
// the same. No guard: NAME names what each copy defines.

bool NAME(picks)(uint x) { return A != 0u && (x & 1u) != 0u; }
uint NAME(least)() { return C; }
uint NAME(early)(uint x) {
  if (A == 0u) return 1u;
  return x < 4u ? 2u : 3u;
}

uint NAME(sum)(uint x) {
  uint sum = 0u;
  for (uint i = 0u; i < 5u; ++i) {
    if (A == 1u && i == x) continue;
    if (B > 2u) break;
    while (A == 2u) {
      sum += 7u;
      break;
    }
    switch (B) {
      case 0u:
        if (i == 3u) break; // from within
        sum += 100u;        // and on to the next case
      case 1u:
        sum += 10u;
        break;
      case 2u:
        if ((x & 3u) == 3u) return sum + 1000u;
      default:
        sum += i;
    }
    if (NAME(picks)(x) || NAME(least)() == 4u)
      sum += 2u;
    else
      sum ^= 1u;
  }
  do {
    if (C == 4u) return sum + NAME(early)(x);
    sum += 3u;
  } while (sum < x);
  return A > B ? sum : sum * 2u;
}
