"""The literature of the equations, and where each equation comes from."""

from __future__ import annotations

REFERENCES: tuple[str, ...] = (
    "[A] Makarem and Cheraghi Mahmudabadi, Accuracy analysis of integrated INS/GNSS navigation in a straight path "
    "with constant velocity for airborne SAR. Journal of Radar 7(2), 2019. Source of [T-1] to [T-7] and [T-9] to "
    "[T-12].",
    "[C] Cheraghi Mahmudabadi, Makarem and Hatam, Challenges of inertial and integrated navigation systems in SAR "
    "application. Source of [T-13] and of the correction limits; its gyro term is printed with √21 where the "
    "integral gives √20, which is used here.",
    "[T-8], [T-15], [T-17], [T-18] and [S-1] to [S-6] are derived in NavBudget and verified against Riccati and "
    "covariance solutions and Monte Carlo runs in its test suite.",
    "The table of inputs gives the source of each sensor and radar value.",
)


def source_of(mark: str) -> str:
    """Where an equation comes from."""
    letter, _, number = mark.partition("-")
    if letter == "T" and (int(number) <= 7 or 9 <= int(number) <= 12):
        return "[A] Makarem and Cheraghi Mahmudabadi 2019"
    if mark == "T-13":
        return "[C] Cheraghi Mahmudabadi, Makarem and Hatam"
    if letter == "B":
        return "derived here after [B] Moghtadaei Rad, Heyrani Nobari and Nikkhah, whose printed equations are lost"
    if mark in {"T-16", "S-7"}:
        return "derived here for the correction of [C] Cheraghi Mahmudabadi, Makarem and Hatam"
    return "derived here"
