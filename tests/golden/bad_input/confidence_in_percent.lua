return at_least(0.9).with_confidence(95)
