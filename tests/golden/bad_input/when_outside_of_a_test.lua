local trial = when { seeds = 30 }
